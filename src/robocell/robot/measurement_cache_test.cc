#include "robocell/robot/measurement_cache.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <string>

#include "robocell/mujoco/owners.h"
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

TEST(MeasurementOfEqualModels, DependsOnTheBytesOfTheModelAndTheName) {
  const Scene scene = Scene::Build(SceneWith({.name = "rc7", .config = Rc7()}));
  const Scene same = Scene::Build(SceneWith({.name = "rc7", .config = Rc7()}));
  int count = 0;
  bool is_kept = true;
  const auto measure = [&](const Scene& of, const std::string& what) {
    return MeasurementOfEqualModels(of.model(), what, [&]() -> MeasuredValues {
      return {{1.0 * ++count}, is_kept};
    })[0];
  };
  EXPECT_EQ(measure(scene, "a"), 1);
  EXPECT_EQ(measure(same, "a"), 1);
  EXPECT_EQ(measure(same, "b"), 2);
  const ModelPtr stiffer = CopyModel(scene.model());
  stiffer->jnt_stiffness[0] += 1;
  EXPECT_EQ(MeasurementOfEqualModels(stiffer.get(), "a", [] { return MeasuredValues{{9}}; })[0], 9);
  is_kept = false;
  EXPECT_EQ(measure(scene, "c"), 3);
  EXPECT_EQ(measure(scene, "c"), 4);
}

// A gripper in a model that was written to is measured as it is then.
TEST(MeasurementOfEqualModels, AChangedGripperIsMeasuredAnew) {
  RobotConfig config = Rc7();
  config.move_groups.find("gripper")->distance.reset();
  const auto open = [&](double share) {
    const auto compiled = CompileScene(SceneWith({.name = "rc7", .config = config}));
    mjModel* m = compiled->mutable_model();
    for (int j = 0; j < m->njnt; ++j) {  // those of the fingers
      if (m->jnt_type[j] != mjJNT_SLIDE) continue;
      for (int i = 0; i < 2; ++i) m->jnt_range[2 * j + i] *= share;
    }
    const Robot robot = Robot::Of(Scene::FromCompiled(compiled), "rc7");
    return robot.gripper().inter_finger_dist_range().upper;
  };
  const double whole = open(1);
  EXPECT_EQ(open(1), whole);
  EXPECT_LT(open(0.5), 0.9 * whole);
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
