// Private to scene: what a scene keeps when it is compiled anew with an object more or less.
//
// All that mj_recompile would lose is kept too: applied forces, warm starts, switched equalities,
// user data, buffers of delays, states of plugins, the engine's counts of warnings.
#pragma once

#include "robocell/scene/element_match.h"

namespace robocell {

// Copies the state of everything that is in both models, and the time. What is new keeps what is in
// `to`.
void CarryState(const ElementMatch& match, const mjData* from, mjData* to);

// Copies what was written to the model while it was simulated: options, which actuators are
// switched off (control modes), and the real numbers and contact masks of everything that is in
// both models: of bodies, joints, geoms, sites, cameras, lights, materials, contact pairs,
// equalities, tendons, actuators and sensors. Masses of subtrees are summed anew. All else is that
// of `to`: what the engine derives from the whole model, other integers and flags, user numbers,
// numerics, keyframes, tendons' wraps, flexes, skins, meshes, height fields and textures.
void CarryModel(const ElementMatch& match, mjModel* to);

}  // namespace robocell
