#include "robocell/robot/measurement_cache.h"

#include <gtest/gtest.h>

#include "robocell/robot/gripper_group.h"
#include "robocell/robot/testing/robots.h"

namespace robocell::internal {
namespace {

TEST(CachedMeasurement, AFrozenModelIsMeasuredOnceForAllItsScenes) {
  const auto compiled = CompileScene(SceneWith({.name = "rc7", .config = Rc7()}));
  int count = 0;
  const auto measure = [&](const std::string& what) {
    return CachedMeasurement(compiled, what, [&] { return std::vector<double>{1.0 * ++count}; })[0];
  };
  EXPECT_EQ(measure("a"), 1);
  EXPECT_EQ(measure("a"), 2) << "it may have been written to";
  compiled->Freeze();
  EXPECT_EQ(measure("a"), 3);
  EXPECT_EQ(measure("a"), 3);
  EXPECT_EQ(measure("b"), 4);
  const auto other = CompileScene(SceneWith({.name = "rc7", .config = Rc7()}));
  other->Freeze();
  EXPECT_EQ(CachedMeasurement(other, "a", [] { return std::vector<double>{9}; })[0], 9);
}

TEST(CachedMeasurement, GoesWithItsModel) {
  const auto measure_new_model = [] {
    const auto compiled = CompileScene(SceneWith({.name = "rc7", .config = Rc7()}));
    compiled->Freeze();
    for (const char* what : {"a", "b"})
      CachedMeasurement(compiled, what, [] { return std::vector<double>{1}; });
  };
  measure_new_model();
  const size_t kept = MeasurementCount();
  for (int i = 0; i < 3; ++i) measure_new_model();
  EXPECT_EQ(MeasurementCount(), kept);
}

TEST(CachedMeasurement, RobotsOnOneModelAreMeasuredLikeSingleRobots) {
  RobotConfig config = Rc7();
  config.reach = std::nullopt;
  const Robot alone = RobotAlone(config);
  const auto compiled = CompileScene(SceneWith({.name = "rc7", .config = config}));
  compiled->Freeze();
  for (int copy = 0; copy < 2; ++copy) {
    const Robot robot = Robot::Of(Scene::FromCompiled(compiled), "rc7");
    EXPECT_EQ(robot.reach(), alone.reach());
    const Interval range = robot.gripper().inter_finger_dist_range();
    EXPECT_EQ(range.lower, alone.gripper().inter_finger_dist_range().lower);
    EXPECT_EQ(range.upper, alone.gripper().inter_finger_dist_range().upper);
  }
}

}  // namespace
}  // namespace robocell::internal
