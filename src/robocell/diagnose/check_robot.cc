#include "robocell/diagnose/check_robot.h"

#include "robocell/diagnose/checks.h"

namespace robocell {

std::vector<Finding> CheckRobot(Robot robot, const RobotCheckOptions& options) {
  internal::Findings findings("robot '" + robot.name() + "'",
                              [&](const std::string& /*subject*/, std::string_view field) {
                                return robot.config().locations.At(field);
                              });
  const internal::TrialOptions trial{.beside_warnings = options.beside_warnings,
                                     .for_run = options.for_run};
  robot.scene().Reset();
  for (internal::RobotTrial* attempt : internal::RobotTrials()) attempt(robot, trial, findings);
  return findings.list();
}

}  // namespace robocell
