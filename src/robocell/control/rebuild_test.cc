// Tests controllers of this layer when objects of their scene are added and removed.
#include <gtest/gtest.h>

#include "robocell/robot/testing/robots.h"

namespace robocell {
namespace {

class ControllersStay : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Kinds, ControllersStay,
                         ::testing::Values("cartesian_pose", "cartesian_impedance",
                                           "joint_impedance", "relative_joint_position"));

// The arm moves like in an untouched scene. Another body changes the rounding of its motion.
TEST_P(ControllersStay, AndTheArmContinuesToItsTarget) {
  const auto run = [&](bool rebuild) {
    Scene scene = Scene::Build(SceneWith({.name = "a", .config = Rc7()}));
    Robot robot = Robot::Of(scene, "a");
    robot.SetController("arm", GetParam());
    const Controller* controller = &robot.controller("arm");
    for (double& number : controller->port_kind() == TargetKind::kPose
                              ? robot.controller("arm").command_port().first(3)
                              : robot.controller("arm").command_port())
      number += 0.02;
    for (int i = 0; i < 80; ++i) {
      if (rebuild && i == 20) scene.AddObject(BoxObject("cube", {0.9, 0.9, 0.02}));
      if (rebuild && i == 60) scene.RemoveObject("cube");
      robot.Update();
      EXPECT_TRUE(robot.Step().ok());
    }
    EXPECT_EQ(&robot.controller("arm"), controller);
    return robot.tcp_in_world();
  };
  const Pose alone = run(false), rebuilt = run(true);
  EXPECT_TRUE(alone.is_close(rebuilt, 1e-8, 1e-8)) << alone << rebuilt;
}

}  // namespace
}  // namespace robocell
