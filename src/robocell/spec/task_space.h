// TaskSpaceConfig: the part of a commanded pose that counts for an arm.
//
//   move_groups:
//     arm: {kind: arm, joints: j1..j4, leaf: {site: tcp}, task_space: {kind: axis, axis: [0, 0, 1]}}
//
// Unset, an arm of six and more degrees of freedom reaches the whole pose. One of fewer reaches the
// position, and the rotation as nearly as its joints allow.
#pragma once

#include <array>
#include <optional>
#include <utility>

#include "robocell/spec/fields.h"
#include "robocell/spec/types.h"

namespace robocell {

class Problems;

enum class TaskSpaceKind {
  kPose,      // position and rotation
  kPosition,  // position, with any rotation
  kAxis,      // position, and the direction of one axis of the TCP
};
template <>
struct EnumNames<TaskSpaceKind> {
  static constexpr std::array kNames = {std::pair{TaskSpaceKind::kPose, "pose"},
                                        std::pair{TaskSpaceKind::kPosition, "position"},
                                        std::pair{TaskSpaceKind::kAxis, "axis"}};
};

struct TaskSpaceConfig {
  TaskSpaceKind kind = TaskSpaceKind::kPose;
  std::optional<Vec3> axis = {};
  std::optional<double> cone = {};
  std::optional<Vec3> position_weights = {};
  std::optional<Vec3> rotation_weights = {};

  static constexpr const char* kTypeName = "TaskSpaceConfig";
  template <class V>
  static void Fields(V&& v) {
    v("kind", &TaskSpaceConfig::kind,
      "pose, position (any rotation), or axis (position and the direction of one axis).");
    v("axis", &TaskSpaceConfig::axis,
      "Of kind axis: the direction in the frame of the TCP. Unset: its z axis.");
    v("cone", &TaskSpaceConfig::cone,
      "Of kind axis: the largest angle to the commanded direction, rad. Unset: 0.",
      Bound::kNonNegative);
    v("position_weights", &TaskSpaceConfig::position_weights,
      "Weights of position errors along the axes of the commanded pose; 0: any. Unset: 1.",
      Bound::kNonNegative);
    v("rotation_weights", &TaskSpaceConfig::rotation_weights,
      "Of kind pose: weights of rotation errors about the axes of the commanded pose; 0: any. "
      "Unset: 1.",
      Bound::kNonNegative);
  }
  void Validate(Problems& problems) const;
};

}  // namespace robocell
