// Finds floating bases that nothing holds up.
#include "robocell/diagnose/trials.h"
#include "robocell/robot/floating_base.h"

namespace robocell::internal {

void TryFloatingBase(Robot& robot, const TrialOptions&, Findings& findings) {
  for (const RobotRecord& record : robot.scene().compiled()->robots()) {
    if (record.name != robot.name()) continue;
    if (const std::string why = WhyBaseFalls(robot.scene(), record); !why.empty())
      findings.WarnAbout("base", why);
  }
}

}  // namespace robocell::internal
