// For tests only: arms for tests of impedance: tilted, so that the base's axes are not the world's,
// without friction that would make them stick, and without compensation of their weight in the
// model.
#pragma once

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <vector>

#include "robocell/robot/testing/robots.h"

namespace robocell {

inline Scene TiltedScene(const RobotCase& robot) {
  RobotSpec spec = robot.spec();
  spec.name = robot.name;
  spec.pos = {0, 0, 1};
  spec.euler = {25, -15, 60};
  if (spec.config) spec.config->gravcomp = false;
  Scene scene = Scene::Build(SceneWith(spec));
  mju_zero(scene.mutable_model()->dof_frictionloss, scene.model()->nv);
  return scene;
}

// Returns the arm in that scene, away from singular postures and limits.
inline Robot BentArm(const Scene& scene, const RobotCase& of) {
  Robot robot = of.robot(scene, of.name);
  robot.SetJointPos(
      of.name == "fr3"
          ? std::vector<double>{0.2, 0.3, -0.2, -1.7, 0.2, 1.9, 0.4}
          : std::vector<double>{0.2, 0.5, -0.3, of.name == "panda" ? -1.6 : 1.2, 0.2, 1.3, 0.4});
  return robot;
}

inline void RunFor(Robot& robot, int steps) {
  for (int i = 0; i < steps; ++i) {
    robot.Update();
    ASSERT_TRUE(robot.Step().ok());
  }
}

}  // namespace robocell
