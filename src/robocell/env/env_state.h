// EnvState: everything that an environment needs to continue identically, as a value: physics,
// targets of its arms, memory of its task, variations drawn for its objects, its clock.
//
//   const EnvState state = env.state();
//   other.SetState(state, StateFrame::kRoot);  // of the same configuration, with its rig elsewhere
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "robocell/math/pose.h"
#include "robocell/spec/fields.h"

namespace robocell {

// Frame in which free and mocap root_frame_objects are placed when a state is set.
enum class StateFrame {
  kWorld,  // same pose in the world; the continuation is the same to the bit
  kRoot,   // same pose in the root frame
};
template <>
struct EnumNames<StateFrame> {
  static constexpr std::array kNames = {std::pair{StateFrame::kWorld, "world"},
                                        std::pair{StateFrame::kRoot, "root"}};
};

// The sum of the moves of a target: metres, and a rotation vector, along the axes of the poses.
struct PendingMove {
  std::array<double, 3> shift = {}, turn = {};
};

// The environment's memory of a gripper's fingers: the time over which they did not move.
struct FingerMemory {
  double still_windows = 0;  // consecutive, up to now
  bool is_still = false;
  double window_start = 0;
  std::vector<double> window;  // shares of the joints' travel at its beginning, and the opening
};

// The environment's memory of an arm: targets of arm and gripper, the origin of relative
// actions, and the windows of time over which the gripper is watched.
struct ArmMemory {
  Pose sent, origin;
  std::vector<double> sent_joints, origin_joints;
  std::vector<double> commanded;  // joints that the arm's controller drives to
  double sent_opening = 1, commanded_opening = 1;
  FingerMemory fingers = {};
  // The part of the target's moves that the arm has not carried out yet, and the arm's position at
  // the last update.
  PendingMove pending = {};
  std::vector<double> pending_joints = {};
  Pose seen = {};
  std::vector<double> seen_joints = {};
};

struct EnvState {
  Pose root_frame_to_world = {};     // root frame of the environment that made the state
  std::vector<double> physics = {};  // Scene::state()
  std::vector<ArmMemory> arms = {};
  std::vector<double> task = {};  // Task::memory()
  // For each object that varies, the factors of mass and friction, and the offsets of its colour.
  std::vector<double> variations = {};
  // Bodies of robots in contact, and the bodies that they touch.
  std::vector<std::pair<int, int>> touching = {};
  int64_t ticks = 0;  // engine steps since the reset
  // Hash of the names of robots, and of the joints, moving bodies and actuators of the numbers, as
  // an integer in the same format as in a file.
  double names_hash = 0;

  // Returns the state as numbers for files.
  std::vector<double> numbers() const;
  // Throws ArgumentError for numbers that are not a state.
  static EnvState FromNumbers(std::span<const double> numbers);
};

}  // namespace robocell
