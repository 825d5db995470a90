// For tests only: robots in scenes, and the problems of those that do not compile.
#pragma once

#include <gmock/gmock.h>
#include <mujoco/mujoco.h>

#include "robocell/mujoco/names.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/scenes.h"

namespace robocell {

class ArmScenes : public ::testing::Test {
 protected:
  // A scene with the two-joint arm under this configuration.
  Scene BuildArm() { return Scene::Build(ArmScene()); }
  SceneSpec ArmScene() {
    SceneSpec spec = EmptyScene();
    spec.robots.push_back({.name = "left", .config = config, .prefix = "l_"});
    return spec;
  }
  double Prm(const Scene& scene, const mjtNum* array, int columns, const char* actuator,
             int column) {
    return array[columns * RequireId(scene.model(), mjOBJ_ACTUATOR, actuator, "") + column];
  }

  ModelFolder folder;
  RobotConfig config = ArmConfig(folder.Write("arm", kTwoJointArm));
  std::string gripper = folder.Write("gripper", kTwoFingerGripper);
};

}  // namespace robocell
