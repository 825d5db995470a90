// Paths of a held object that bring about a relation: into a hole, over a region that is wiped, and
// over a vessel that is poured into.
#pragma once

#include <optional>
#include <vector>

#include "robocell/math/pose.h"
#include "robocell/motion/planning_scene.h"
#include "robocell/scene/scene.h"
#include "robocell/scenes/relations.h"
#include "robocell/task/grasp_motion.h"
#include "robocell/task/held_motion.h"
#include "robocell/task/refusal.h"

namespace robocell::internal {

// The reason of starts in which no grasp allows the motion.
inline constexpr const char* kNoHeldMotion = "the object cannot be moved as the goal requires";
inline constexpr double kOverHole = 0.02;    // m between a hole and what is about to go in
inline constexpr double kOverWiped = 0.004;  // m between a region and what is about to wipe it

// Returns true if such a relation needs one: inserted, wiped or poured_into.
bool HasHeldPaths(const StatedRelation& stated);
// Returns the paths, best first, of an object that is held at `lifted` (world).
//   inserted     from over the hole to its bottom
//   wiped        over the region from side to side, a little above it
//   poured_into  upright to the vessel, tilted over it and back
std::vector<HeldPath> HeldPaths(const Scene& scene, const StatedRelation& stated,
                                const BoundRelation& bound, const Pose& lifted);
// Refuses a grasp of the object, as it lies now, after which the arm cannot follow any of these. It
// changes the planning scene.
std::optional<Refusal> CheckHeldPaths(const Scene& scene, const StatedRelation& stated,
                                      const BoundRelation& bound, PlanningScene& planning,
                                      const GraspMotion& motion);

}  // namespace robocell::internal
