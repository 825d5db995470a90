// EnvState: everything that an environment needs to go on as it did, as a value: physics, where its
// arms were sent, what its task remembers, what was drawn for its objects, its clock.
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
  kWorld,  // where they were in the world; what follows is the same to the bit
  kRoot,   // where they were in the root frame
};
template <>
struct EnumNames<StateFrame> {
  static constexpr std::array kNames = {std::pair{StateFrame::kWorld, "world"},
                                        std::pair{StateFrame::kRoot, "root"}};
};

struct EnvState {
  Pose root_frame_to_world = {};     // of the environment that it was taken from
  std::vector<double> physics = {};  // Scene::state()
  std::vector<ArmDriver::Memory> arms = {};
  std::vector<double> task = {};        // Task::memory()
  std::vector<double> variations = {};  // ObjectVariations::drawn()
  CollisionMonitor::Memory touching = {};
  int64_t ticks = 0;  // engine steps since the reset
  // Hash of the names of robots, and of the joints, moving bodies and actuators of the numbers, as
  // an integer in the same format as in a file.
  double names_hash = 0;

  // For files.
  std::vector<double> numbers() const;
  // ArgumentError for numbers that are no state.
  static EnvState FromNumbers(std::span<const double> numbers);
};

}  // namespace robocell
