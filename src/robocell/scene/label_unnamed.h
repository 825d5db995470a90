// Private to scene: gives unnamed elements of a model a label as name, so that everything can be
// found by name, in a robot's file and in a rebuilt scene.
//
// A label gives the element's place: `elbow:joint0` is the first joint of body `elbow`,
// `hand:body1` its second child, `flange:site0` a site; `joint2:actuator0` the first actuator that
// acts on `joint2`. Geoms, cameras, lights and other elements that nothing looks up by name stay
// unnamed.
#pragma once

#include <string>

#include "robocell/mujoco/forward.h"

struct mjSpec_;
typedef struct mjSpec_ mjSpec;

namespace robocell::internal {

// Labels the bodies, joints, sites and actuators of a model that have no name. `root` is the label
// of a body in the model's world; further ones get a number.
void LabelUnnamed(mjSpec* spec, const std::string& root);

// Returns " ('elbow:joint0' has no name in the model; to give it one: edits: [{joint: {body: elbow,
// index: 0}, name: NAME}])" for a label; "" for other names of joints. For messages.
std::string HowToNameJoint(const std::string& label);

}  // namespace robocell::internal
