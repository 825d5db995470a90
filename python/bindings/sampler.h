// Samplers written in Python, for the runner.
#pragma once

#include <functional>
#include <memory>

#include "bindings.h"
#include "python_owner.h"
#include "robocell/spec/run_config.h"
#include "robocell/task/task_sampler.h"

namespace robocell::python {

using SamplerFactory = std::function<std::shared_ptr<TaskSampler>(const RunConfig&)>;

// Wraps a Python function (run) -> TaskSampler; empty without one. `made` is a slot for the
// sampler's Python object, which lives as long as it is in the slot.
SamplerFactory MakeSamplerFactory(const SharedKeeper& make_sampler, const SharedKeeper& made);

// For tp_traverse of an owner: visits a sampler that only it has, else what that sampler has.
int VisitSampler(const std::shared_ptr<TaskSampler>& sampler, visitproc visit, void* arg);

// For classes of samplers, which may have a source of scenes written in Python.
extern PyType_Slot sampler_slots[];

}  // namespace robocell::python
