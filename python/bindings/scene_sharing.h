// A scene's model and data as real mujoco.MjModel and mujoco.MjData, without copies.
//
// C++ compiles the model and hands it over to Python once; Python makes the data and C++ uses it.
// Both sides keep the Python objects alive.
#pragma once

#include "bindings.h"
#include "robocell/scene/scene.h"

namespace robocell::python {

// Imports the package mujoco. Throws Error if its version is not the one that robocell was built
// for, or if MUJOCO_GL prevents the import.
nb::object ImportMujoco();

// Returns the mujoco.MjModel of a compiled scene, the same object every time. Its arrays are
// read-only if the scene is frozen.
nb::object ModelOf(CompiledScene& compiled);
// Freezes it, and makes the arrays of a model that Python already has read-only.
void Freeze(CompiledScene& compiled);
// Returns the mujoco.MjData of a scene. Throws Error for a scene that C++ made without Python's
// data.
nb::object DataOf(const Scene& scene);

// Makes data that Python owns. For scenes made by C++ code that Python will use; takes the GIL.
DataFactory PythonData();

}  // namespace robocell::python
