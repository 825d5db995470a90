// The two fingers of a gripper: the geoms, bodies or sites that a configuration names, as ids in
// the present model, and the free distance between them. How they are moved is gripper_group.h's.
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
  int site = -1;           // set when the finger is named by a site
  int body = -1;           // the body that carries it
  bool is_body = false;    // named by that body, not by a geom or site of it
  std::vector<int> geoms;  // what the distance is measured between: the geom named, or the body's
                           // colliding geoms
  std::vector<int> side;   // all geoms between hand and fingertip: what touches for this finger
};

struct FingerPair {
  int hand = -1;  // the lowest body that carries both
  std::array<Finger, 2> fingers;
};

// From two geoms, bodies or sites. ArgumentError when both are parts of one rigid body.
FingerPair MakeFingers(const mjModel* model, ElementId first, ElementId second,
                       const std::string& place);

// The bodies at the ends of two fingers, from the bodies that the gripper's joints move: those
// themselves, or with linkages the parts that grip. A linkage is what hangs on the body and what
// `connect` and `weld` constraints tie to that; its end is the body with the colliding geom
// farthest from the hand while all joints are at their reference positions.
std::array<int, 2> FingertipBodies(const mjModel* model, int first, int second);

// A finger that turns about one hinge in the other: as the moving jaw of two, the other being part
// of the hand. None where both are named by geoms or sites: somebody chose what is measured.
struct Jaw {
  int index;  // which of the two it is
  int joint;
};
std::optional<Jaw> FindJaw(const mjModel* model, const FingerPair& pair);

// Returns true if the largest distance of the two within the jaw's range is that of points near the
// hinge, so that it says little about the tips. Other joints are at `qpos` (nq). EngineError if the
// model is too large for another mjData.
bool IsMeasuredAtItsHinge(const mjModel* model, std::span<const double> qpos,
                          const FingerPair& pair, const Jaw& jaw);

// Advice: "'jaw' turns about a hinge in 'hand', ...: name the tips of both ...".
std::string HowToNameTips(const mjModel* model, const FingerPair& pair, const Jaw& jaw);

// Metres; 0 when they overlap. Needs data at position stage. No allocation.
double FingerDistance(const mjModel* model, mjData* data, const Finger& a, const Finger& b);

}  // namespace robocell::internal
