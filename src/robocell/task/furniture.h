// Furniture: objects that stand fixed on a support and have joints of their own: chests, cupboards,
// boxes with a lid, panels with buttons.
#pragma once

#include <functional>
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

// Returns furniture that stands fixed on the first support with room for it, else on the floor. In a
// scene with robots its front (+x) looks to the first of them, within reach of an arm; else over an
// edge of the support, which its handles may overhang. It keeps kBesideFurniture to everything that
// has a place in `spec`, and has free space in front. Throws ArgumentError if there is no such place.
SceneObject PutFurniture(const SceneSpec& spec, const SceneAnnotations& annotations,
                         const std::string& name, const std::string& kind, Rng& rng);

// Refuses a stance from which the robot cannot do what it is for.
using StanceCheck = std::function<std::optional<Refusal>()>;

// Moves the robot's base around the root of furniture until it stands free, outside of what the joint
// moves through, the way of the joint's handle to a share of its range is within reach, and `check`
// accepts. The height stays. It begins in front of the handle at the present distance, and goes aside,
// nearer and farther from there; for a joint that is pressed from above it begins where the base is. A
// base that is far from the handle is moved around the handle. Refuses without such a place.
std::optional<Refusal> StandInFront(Scene& scene, const Robot& robot, int root,
                                    const JointOpening& opening, double share,
                                    const StanceCheck& check, Rng& rng);

}  // namespace robocell::internal
