#include "robocell/robot/arm_ik.h"

#include <gtest/gtest.h>

#include "robocell/assets/resolve.h"
#include "robocell/scene/scene.h"
#include "robocell/spec/robot_config.h"

namespace robocell {
namespace {

Scene SceneWithTaskSpace(const TaskSpaceConfig& task_space) {
  SceneSpec spec{.name = "arm", .timestep = 0.002, .add_floor = true, .add_skybox = false};
  RobotConfig config = RobotConfig::Load(assets::BuiltinRobotFile("rc7"));
  config.move_groups.at("arm").task_space = task_space;
  spec.robots.push_back({.name = "arm", .config = config});
  return Scene::Build(spec);
}

TEST(ForArm, OptionsHaveTheTaskSpaceOfTheArm) {
  Scene scene = SceneWithTaskSpace({.kind = TaskSpaceKind::kPosition});
  const Robot robot = Robot::Of(scene, "arm");
  EXPECT_TRUE(ForArm(robot, {}).position_only);
  const Pose out_of_turn = (robot.base_in_world().inverse() * robot.tcp_in_world()) *
                           Pose::FromRpy({0.02, 0, 0}, {0, 0, 3});
  const IkResult found = Ik(robot.chain(), out_of_turn, ForArm(robot, {}));
  EXPECT_TRUE(found.success);
  EXPECT_LT((robot.chain().Fk(found.q).translation() - out_of_turn.translation()).norm(), 1e-5);
}

TEST(ForArm, OptionsThatChooseAPartAreKept) {
  Scene scene = SceneWithTaskSpace({.kind = TaskSpaceKind::kPosition});
  const Robot robot = Robot::Of(scene, "arm");
  const IkOptions turned = ForArm(robot, {.axis = Eigen::Vector3d::UnitZ(), .cone = 0.1});
  EXPECT_FALSE(turned.position_only);
  EXPECT_EQ(turned.cone, 0.1);
  EXPECT_FALSE(ForArm(robot, {.rotation_weights = {1, 1, 0}}).position_only);
}

}  // namespace
}  // namespace robocell
