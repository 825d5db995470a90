// Private to scene: the engine's global settings. They belong to the scene: parts lose theirs when
// they are attached, so they are set once everything is together, and what parts asked for is said.
#pragma once

#include <string>

#include "robocell/mujoco/engine_defects.h"
#include "robocell/mujoco/forward.h"
#include "robocell/scene/compile_log.h"
#include "robocell/spec/scene_spec.h"

typedef struct mjOption_ mjOption;

namespace robocell::internal {

// Sets options, timestep (unless unset) and gravity of the scene. Names of flags that do not exist
// are problems.
void ApplyOptions(const SceneSpec& scene, mjSpec* spec, CompileLog& log);

// Whether compiling may replace a sparse Jacobian: not when the scene says which it wants.
JacobianGuard GuardOf(const SceneSpec& scene);

// Warns when the scene insists on a solver that this engine is known to be wrong with.
void WarnWrongSolver(const SceneSpec& scene, const mjModel* model, CompileLog& log);

// Warns about integrator, cone, impratio, solver and the like that a part asks for and does not
// get.
void WarnOtherOptions(const mjOption& part, const SimOptions& scene, const std::string& place,
                      CompileLog& log);

// The same for the base of a scene, whose options stay where the scene says nothing.
void WarnReplacedOptions(const mjOption& base, const SceneSpec& scene, CompileLog& log);

// Resets options, visual settings and statistics of a part to the engine's defaults, so that
// attaching it cannot change the scene's.
void DropGlobals(mjSpec* part);

}  // namespace robocell::internal
