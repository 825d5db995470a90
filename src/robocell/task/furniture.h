// Furniture: objects that stand fixed on a support and have joints of their own: chests, cupboards,
// boxes with a lid, panels with buttons.
#pragma once

#include <optional>
#include <string>

#include "robocell/base/rng.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"
#include "robocell/scenes/joint_opening.h"
#include "robocell/scenes/scene_annotations.h"
#include "robocell/spec/scene_object.h"
#include "robocell/spec/scene_spec.h"
#include "robocell/task/refusal.h"

namespace robocell::internal {

inline constexpr double kBesideFurniture = 0.02;  // m

// Returns true for a model whose parts move on hinges or slides.
bool IsFurniture(const std::string& kind);

// Returns furniture that stands fixed on the first support with room for it, with its front (+x)
// over an edge, else on the floor, with its front towards the first robot of the scene. It keeps
// kBesideFurniture to everything that has a place in `spec`, and has free space in front. Throws
// ArgumentError if there is no such place.
SceneObject PutFurniture(const SceneSpec& spec, const SceneAnnotations& annotations,
                         const std::string& name, const std::string& kind, Rng& rng);

// Moves the robot's base around a body, the root of the furniture, to in front of the joint's handle,
// at the same distance and height; refuses if it stands free nowhere there. A joint that is pressed
// from above has no front: the base stays.
std::optional<Refusal> StandInFront(Scene& scene, const Robot& robot, int body,
                                    const JointOpening& opening, Rng& rng);

}  // namespace robocell::internal
