// For tests only: small valid specs, for tests that change one field.
#pragma once

#include "robocell/spec/robot_config.h"
#include "robocell/spec/scene_object.h"
#include "robocell/spec/types.h"

namespace robocell {

inline RobotConfig ArmFile() {
  return {.name = "arm",
          .model = "arm.xml",
          .move_groups = {{"arm", {.kind = MoveGroupKind::kArm, .joints = {"a", "b"}}},
                          {"hand",
                           {.kind = MoveGroupKind::kGripper,
                            .joints = {"l", "r"},
                            .actuators = {"grip"},
                            .fingers = {{.name = "lf"}, {.name = "rf"}},
                            .ctrl = GripperCtrl{.open = 0, .closed = 255}}}},
          .home = {{"arm", {0, 1}}}};
}

inline SceneObject Cube(const std::string& name) {
  return {.name = name,
          .shape = Shape::kBox,
          .size = Vec3{.02, .02, .02},
          .rgba = Vec4{1, 0, 0, 1},
          .mass = .1,
          .friction = Vec3{1, 0, 0}};
}

}  // namespace robocell
