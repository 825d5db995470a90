// Private to scene: the engine's global settings. They belong to the scene: parts lose theirs when
// they are attached, so they are set once everything is together, and lost settings are reported.
#pragma once

#include <string>

#include "robocell/mujoco/engine_defects.h"
#include "robocell/mujoco/forward.h"
#include "robocell/scene/compile_log.h"
#include "robocell/spec/scene_spec.h"

typedef struct mjOption_ mjOption;

namespace robocell::internal {

// Sets options, timestep (unless unset) and gravity of the scene. Unknown names of flags are
// problems.
void ApplyOptions(const SceneSpec& scene, mjSpec* spec, CompileLog& log);

// Returns whether compiling may replace a sparse Jacobian: not if the scene chooses one.
JacobianGuard GuardOf(const SceneSpec& scene);

// Warns if the scene insists on a solver that is known to be wrong in this engine.
void WarnWrongSolver(const SceneSpec& scene, const mjModel* model, CompileLog& log);

// Warns about integrator, cone, impratio, solver and other options that a part specifies and does
// not get.
void WarnOtherOptions(const mjOption& part, const SimOptions& scene, const std::string& place,
                      CompileLog& log);

// Warns about options of the base of a scene that the scene replaces; the others stay.
void WarnReplacedOptions(const mjOption& base, const SceneSpec& scene, CompileLog& log);

// Resets options, visual settings and statistics of a part to the engine's defaults, so that
// attaching it cannot change the scene's.
void DropGlobals(mjSpec* part);

}  // namespace robocell::internal
