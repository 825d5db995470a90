// The actions of an environment: their meaning and their reference.
#pragma once

#include <array>
#include <utility>

#include "robocell/spec/fields.h"

namespace robocell {

enum class ControlMode {
  kJoints,          // joint positions
  kCartesianTrpy,   // translation, roll pitch yaw (extrinsic xyz)
  kCartesianTquat,  // translation, quaternion xyzw
};
template <>
struct EnumNames<ControlMode> {
  static constexpr std::array kNames = {std::pair{ControlMode::kJoints, "joints"},
                                        std::pair{ControlMode::kCartesianTrpy, "cartesian_trpy"},
                                        std::pair{ControlMode::kCartesianTquat, "cartesian_tquat"}};
};

enum class RelativeTo {
  kLastStep,          // the robot's last target
  kConfiguredOrigin,  // the position at the reset, or the origin set since
  kNone,              // nothing: actions are absolute
};
template <>
struct EnumNames<RelativeTo> {
  static constexpr std::array kNames = {
      std::pair{RelativeTo::kLastStep, "last_step"},
      std::pair{RelativeTo::kConfiguredOrigin, "configured_origin"},
      std::pair{RelativeTo::kNone, "none"}};
};

// The largest step of one action: metres and radians; joints use their own unit with the rotation's
// limit.
struct StepLimit {
  double translation = 0;
  double rotation = 0;
};

// The effect of a collision on a step.
enum class OnCollision { kReport, kStop, kGuard };
template <>
struct EnumNames<OnCollision> {
  static constexpr std::array kNames = {std::pair{OnCollision::kReport, "report"},
                                        std::pair{OnCollision::kStop, "stop"},
                                        std::pair{OnCollision::kGuard, "guard"}};
};

}  // namespace robocell
