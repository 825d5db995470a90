// Keeps robots out of the swing of doors: a door that cannot open or close is no start for a task in
// a house. A robot that opens a door itself stands in its swing, but not in the way of the part that
// it moves.
#pragma once

#include <optional>
#include <vector>

#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"
#include "robocell/scenes/joint_opening.h"
#include "robocell/scenes/scene_annotations.h"
#include "robocell/task/refusal.h"

namespace robocell::internal {

inline constexpr double kLeastDoorHeight = 1.5;  // metres; lower ones are doors of furniture

// Returns the hinged doors among the articulations of a scene that are high enough for people.
std::vector<Articulation> DoorsOf(const SceneAnnotations& annotations, const Scene& scene);

// Returns the positions of a hinge at which its swing is checked, all over its range. After a turn they
// come again.
std::vector<double> SwingOf(const Articulation& door);

// Refuses a robot whose base is nearer than `clearance` (metres) to a place that the joint's body takes
// up on its way from the present position to a share of its range. The arm goes along with the body.
std::optional<Refusal> ValidateMovedJoint(Scene& scene, const Robot& robot,
                                          const JointOpening& opening, double share,
                                          double clearance);

// Refuses a robot that is nearer than `clearance` (metres) to a place which one of the doors takes
// up somewhere in its range. The scene's poses are up to date, and stay as they are.
std::optional<Refusal> ValidateDoorSwings(Scene& scene, const Robot& robot,
                                          const std::vector<Articulation>& doors, double clearance);

}  // namespace robocell::internal
