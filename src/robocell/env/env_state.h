// EnvState: everything that an environment needs to continue identically, as a value: physics,
// targets of its arms, memory of its task, variations drawn for its objects, its clock.
//
//   const EnvState state = env.state();
//   other.SetState(state, StateFrame::kRoot);  // of the same configuration, with its rig elsewhere
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "robocell/env/arm_driver.h"
#include "robocell/env/collision_monitor.h"
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

struct EnvState {
  Pose root_frame_to_world = {};     // root frame of the environment that made the state
  std::vector<double> physics = {};  // Scene::state()
  std::vector<ArmDriver::Memory> arms = {};
  std::vector<double> task = {};        // Task::memory()
  std::vector<double> variations = {};  // ObjectVariations::drawn()
  CollisionMonitor::Memory touching = {};
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
