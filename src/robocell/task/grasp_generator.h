// Grasps of any object by any hand, from the object's collision geometry: primitives exactly, meshes
// by their convex hulls. The arm, its reach and the surroundings play no part (reachable_grasps.h).
//
//   const GraspSet grasps = GenerateGrasps(robot, "mug");
//   const GraspSet handle = GenerateGrasps(robot, "door", {.kinds = {GraspKind::kHandle}});
//
// Two fingers: points are drawn uniformly over the surface, with the point on the other side of the
// solid along the normal. The pads must cover both within the friction cones, and the object must
// fit between the open fingers. The hand comes from directions all around. Three and more fingers
// also close around the object, each until it touches. Cups need a flat face. The tip of the closed
// hand pushes faces, and hooks bars. Every grasp is checked with the hand's real geometry against the
// object by the engine's distances, along its approach too: at places so near to each other that
// bars, rims and plates do not pass between them. At most 1000 + 20 * `most` proposals are checked.
//
// The same geometry, options and seed give the same grasps, wherever the object is and whatever
// else the scene has; the other parts of an articulated object are obstacles, where they are now.
// Throws NotFoundError for unknown names, ArgumentError for options that do not fit, and the errors
// of GripperShape::Of. Threads: those of the scene.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"
#include "robocell/task/grasp.h"

namespace robocell {

struct GraspOptions {
  // Kinds to generate; empty: those that hold, which are all that the hand can do but push and hook.
  std::vector<GraspKind> kinds = {};
  // Full names of the geoms to grasp. Empty: of kHandle and kHook those whose own names contain
  // handle or knob (scenes/handle_geoms.h), of the others all of the body. Geoms that are named
  // together with kHandle count as handles, whatever their names are.
  std::vector<std::string> geoms = {};
  int samples = 3000;  // points drawn on the surface, at most 50 000
  int most = 200;      // grasps kept, the best; at most 2000
  uint64_t seed = 0;
  double friction = 0.5;          // coefficient: normals may differ by its angle from the force
  double clearance = 0.001;       // m between hand and object before contact
  double approach_length = 0.08;  // m
};

// Returns the grasps of a body with what is rigidly fixed to it, best first. Empty without a
// collision geom that fits the hand.
GraspSet GenerateGrasps(const Robot& robot, const std::string& body,
                        const GraspOptions& options = {});

// Returns the names of the geoms of a body that are handles by their names ("handle", "knob").
// Geoms without a name have none.
std::vector<std::string> HandleGeomsOf(const Scene& scene, const std::string& body);

}  // namespace robocell
