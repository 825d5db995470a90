// A scene's model and data as real mujoco.MjModel and mujoco.MjData, without copies.
//
// The model is compiled in C++ and handed over to Python once; the data is made by Python and used
// by C++. Both sides keep the Python objects alive.
#pragma once

#include "bindings.h"
#include "robocell/scene/scene.h"

namespace robocell::python {

// The package mujoco, imported now; an Error when its version is not the one we were built for, or
// when MUJOCO_GL keeps it from being imported.
nb::object ImportMujoco();

// mujoco.MjModel of a compiled scene, the same object every time. Its arrays are read-only when the
// scene is frozen.
nb::object ModelOf(CompiledScene& compiled);
// Freezes it, and makes the arrays of a model that Python has already read-only.
void Freeze(CompiledScene& compiled);
// mujoco.MjData of a scene. An Error for a scene that C++ made without Python's data.
nb::object DataOf(const Scene& scene);

// Makes data that Python owns. For scenes made by C++ code that Python will see; takes the GIL.
DataFactory PythonData();

}  // namespace robocell::python
