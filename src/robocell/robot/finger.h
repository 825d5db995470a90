// The two fingers of a gripper: the geoms, bodies or sites that a configuration names, as ids in
// the present model, and the free distance between them. Of three and more fingers the first closes
// against all others, which count as one. gripper_group.h moves them.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "robocell/mujoco/forward.h"
#include "robocell/scene/element_lookup.h"

namespace robocell::internal {

struct Finger {
  std::vector<int> sites;  // set when the finger is named by a site; several of several fingers
  int body = -1;           // the body that carries it, of several fingers the first one
  bool is_body = false;    // named by that body, not by a geom or site of it
  std::vector<int> geoms;  // those of the measured distance: the named geom, or the body's
                           // colliding geoms
  std::vector<int> side;   // all geoms between hand and fingertip; contacts count for this finger
};

struct FingerPair {
  int hand = -1;  // the lowest body that carries both
  std::array<Finger, 2> fingers;
};

// Makes fingers from two geoms, bodies or sites. Throws ArgumentError if both are parts of one
// rigid body.
FingerPair MakeFingers(const mjModel* model, ElementId first, ElementId second,
                       const std::string& place);
// Makes the first finger and its counterpart, all others. The same errors.
FingerPair MakeFingers(const mjModel* model, std::span<const ElementId> elements,
                       const std::string& place);

// Returns the bodies at the ends of two fingers, from the bodies that the gripper's joints move:
// those themselves, or with linkages the parts that grip. A linkage is the subtree of the body and
// everything that `connect` and `weld` constraints tie to it; its end is the body with the
// colliding geom farthest from the hand while all joints are at their reference positions.
std::array<int, 2> FingertipBodies(const mjModel* model, int first, int second);

// A finger that turns about one hinge in the other finger, like the moving jaw of a hand whose
// other jaw is fixed. Unset if both are named by geoms or sites, because the measured parts were
// chosen.
struct Jaw {
  int index;  // index of the moving one
  int joint;
};
std::optional<Jaw> FindJaw(const mjModel* model, const FingerPair& pair);

// Returns true if the largest distance of the two within the jaw's range is between points near the
// hinge, so that it says little about the tips. Other joints are at `qpos` (nq). Throws EngineError
// if the model is too large for another mjData.
bool IsMeasuredAtItsHinge(const mjModel* model, std::span<const double> qpos,
                          const FingerPair& pair, const Jaw& jaw);

// Returns advice: "'jaw' turns about a hinge in 'hand', ...: name the tips of both ...".
std::string HowToNameTips(const CompiledScene& scene, const RobotRecord& robot,
                          const FingerPair& pair, const Jaw& jaw);

// The nearest points of two fingers, in the world. The distance is negative if they overlap, and 1
// for fingers that are farther apart, whose points are not looked for.
struct NearestPoints {
  double distance = 1;
  double first[3] = {}, second[3] = {};
};

// Needs data at position stage. No allocation.
NearestPoints NearestOf(const mjModel* model, mjData* data, const Finger& a, const Finger& b);

// Returns metres; 0 if they overlap. Needs data at position stage. No allocation.
double FingerDistance(const mjModel* model, mjData* data, const Finger& a, const Finger& b);

}  // namespace robocell::internal
