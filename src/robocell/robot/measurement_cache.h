// Measurements of a model, made once for all scenes that share it, and for all models with the same
// bytes: copies of an environment have one model, checks of one robot file have equal ones. Private
// to robot.
//
//   const double reach = CachedMeasurement(scene.compiled(), "reach from link0 to hand", [&] {
//     return std::vector<double>{ApproximateReach(chain)};
//   })[0];
#pragma once

#include <mujoco/mujoco.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "robocell/scene/compiled_scene.h"

namespace robocell::internal {

// Returns the earlier result of `measure` for this model and this name, or calls it. A model that
// is not frozen may have been written to since, so it is measured each time. Thread-safe.
std::vector<double> CachedMeasurement(const std::shared_ptr<const CompiledScene>& compiled,
                                      const std::string& what,
                                      const std::function<std::vector<double>()>& measure);

struct MeasuredValues {
  std::vector<double> values;
  bool is_kept = true;  // false: equal models are measured again, e.g. to warn of each of them
};

// Returns the earlier result of `measure` for a model with the same bytes and this name, or calls
// it. `what` names everything else that the result depends on. Thread-safe.
std::vector<double> MeasurementOfEqualModels(const mjModel* model, const std::string& what,
                                             const std::function<MeasuredValues()>& measure);

// Returns the number of results that CachedMeasurement keeps. Each new one removes those of models that are gone.
std::size_t MeasurementCount();

}  // namespace robocell::internal
