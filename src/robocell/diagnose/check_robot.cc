#include "robocell/diagnose/check_robot.h"

#include "robocell/diagnose/trials.h"

namespace robocell {
namespace {

#define ROBOCELL_ADDRESS(function) &internal::function,
constexpr internal::RobotTrial* kRobotTrials[] = {ROBOCELL_ROBOT_TRIALS(ROBOCELL_ADDRESS)};
#undef ROBOCELL_ADDRESS

}  // namespace

std::vector<Finding> CheckRobot(Robot robot, const RobotCheckOptions& options) {
  internal::Findings findings("robot '" + robot.name() + "'",
                              [&](const std::string& /*subject*/, std::string_view field) {
                                return robot.config().locations.At(field);
                              });
  const internal::TrialOptions trial{.beside_warnings = options.beside_warnings,
                                     .for_run = options.for_run};
  robot.scene().Reset();
  for (internal::RobotTrial* attempt : kRobotTrials) attempt(robot, trial, findings);
  return findings.list();
}

}  // namespace robocell
