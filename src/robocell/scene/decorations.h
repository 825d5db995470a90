// Private to scene: optional floor, sky and light, and the visual settings of a scene.
#pragma once

#include "robocell/mujoco/forward.h"
#include "robocell/spec/scene_spec.h"

namespace robocell::internal {

// Adds a floor, the plane `floor` at z = 0, and a sky: a gradient, and two lights unless the base
// has its own.
void AddDecorations(const SceneSpec& scene, mjSpec* spec);

// Fixes the size of the scene and the clip planes, in the model and in the spec: the engine
// computes the size from the initial pose and scales the clip planes with it, which can clip a
// scene. Cameras see from 1 cm to 100 m.
void FixVisibleRange(mjSpec* spec, mjModel* model);

}  // namespace robocell::internal
