#include "robocell/task/navigate_kind.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "robocell/assets/resolve.h"
#include "robocell/spec/problems.h"
#include "robocell/spec/robot_config.h"

namespace robocell::internal {
namespace {

using ::testing::HasSubstr;

std::string ProblemsOf(const RobotConfig& robot) {
  Problems problems;
  ValidateDrivenPlanarBase(robot, problems);
  std::string text;
  for (const auto& problem : problems.list()) text += problem.message;
  return text;
}

TEST(NavigateKind, TakesRobotsWhosePlanarBaseIsDriven) {
  EXPECT_EQ(ProblemsOf(RobotConfig::Load(assets::BuiltinRobotFile("cart"))), "");
  RobotConfig mobile = RobotConfig::Load(assets::BuiltinRobotFile("rc7_mobile"));
  EXPECT_EQ(ProblemsOf(mobile), "");
  mobile.move_groups["base"].actuators = {};
  EXPECT_THAT(ProblemsOf(mobile), HasSubstr("no group of kind `base` with the actuators"));
  EXPECT_THAT(ProblemsOf(RobotConfig::Load(assets::BuiltinRobotFile("rc7"))),
              HasSubstr("drives a base that moves in a plane"));
}

}  // namespace
}  // namespace robocell::internal
