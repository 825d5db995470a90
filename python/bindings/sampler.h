// Samplers written in Python, for the runner.
#pragma once

#include <functional>
#include <memory>

#include "bindings.h"
#include "robocell/spec/run_config.h"
#include "robocell/task/task.h"

namespace robocell::python {

using SamplerFactory = std::function<std::shared_ptr<TaskSampler>(const RunConfig&)>;

// From a Python function (run) -> TaskSampler; empty for None.
SamplerFactory MakeSamplerFactory(nb::object make_sampler);

}  // namespace robocell::python
