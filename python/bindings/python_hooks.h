// Finds out whether hooks of a run or an environment are written in Python. The scenes that they are
// called with have Python's data then, so that `scene.data` is a mujoco.MjData in all of them; other
// scenes keep C++'s own, which is made faster and without the GIL.
#pragma once

#include <string>
#include <vector>

#include "robocell/scene/scene.h"
#include "robocell/spec/env_config.h"
#include "robocell/spec/run_config.h"

namespace robocell::python {

// Return true if a task, a sampler, an expert or a feature by these names is written in Python.
bool HasPythonHooks(const RunConfig& run);
bool HasPythonHooks(const EnvConfig& config);
bool HasPythonFeature(const std::vector<std::string>& names);

// Returns PythonData (scene_sharing.h) for hooks in Python, else a factory that is empty.
DataFactory DataForHooks(bool are_in_python);

}  // namespace robocell::python
