// Judges what the measured distance of two fingers says about their motion between two states.
// gripper_range.h measures it.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "robocell/mujoco/forward.h"
#include "robocell/robot/finger.h"
#include "robocell/scene/element_lookup.h"

namespace robocell::internal {

// A distance that hardly changes on a part of the way: like that of two fingers on hinges, which
// are nearest at the hinges while their tips are apart.
struct FlatDistance {
  double distance = 0;  // there, m
  double share = 0;     // share of the path between the two states
  // The points of the fingers that are nearest where they are closed, in the frames of their
  // bodies, and whether the distance of these follows the whole motion.
  bool points_follow = false;
  std::array<std::array<double, 3>, 2> points = {};
};

// Returns the longest such part, if it is more than a quarter of the straight line between two
// states (nq each). Takes milliseconds.
std::optional<FlatDistance> FindFlatDistance(const mjModel* model, const FingerPair& pair,
                                             std::span<const double> from,
                                             std::span<const double> to);

// Returns a description with the edits that help: sites at the points, named as fingers.
std::string HowToFollow(const CompiledScene& scene, const RobotRecord& robot,
                        const FingerPair& pair, const FlatDistance& flat);

// Geoms of the two fingers that press into each other at rest: their distance is 0, and the
// fingers bend past the place where they meet.
struct PressedFingers {
  std::array<int, 2> geoms = {};
  double depth = 0;  // m
};

// Returns the deepest pair in the contacts of the data, if it is so deep that it counts: more than
// a share of the `travel` (m) that the distance has, or more than half of the thinner geom.
std::optional<PressedFingers> FindPressedFingers(const mjModel* model, const mjData* data,
                                                 const FingerPair& pair, double travel);

// Returns a description with the edits that help. `actuators` press them, with forces `pushed`.
std::string HowToPressLess(const mjModel* model, const RobotRecord& robot,
                           const PressedFingers& pressed, std::span<const int> actuators,
                           std::span<const double> pushed);

}  // namespace robocell::internal
