// For tests only: an arm whose wrist is a group of its own.
#pragma once

#include "robocell/robot/group_core.h"

namespace robocell {

inline GroupNames WristNames() {
  const FrameName base{false, "base_link"};
  return {.robot = "rc7",
          .group = "wrist",
          .joints = {"joint6", "joint7"},
          .actuators = {"servo6", "servo7"},
          .root = {false, "link5"},
          .leaf = {true, "tcp"},
          .robot_base = base};
}

}  // namespace robocell
