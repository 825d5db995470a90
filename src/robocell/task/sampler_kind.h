// The kinds of samplers, which decide where episodes start. A run file may name one (`sampler:
// ...`) to replace its task's own sampler. Custom kinds are registered like tasks and experts:
//
//   RegisterSampler("on_the_floor", std::make_shared<SamplerKindOf<OnTheFloor>>());
//
// This file includes no concrete sampler; the code that runs tasks includes it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "robocell/spec/run_config.h"
#include "robocell/task/task_sampler.h"

namespace robocell {

class SamplerKind {
 public:
  virtual ~SamplerKind() = default;
  virtual std::shared_ptr<TaskSampler> Make(const RunConfig& run) const = 0;
  // Returns the source files that define a custom kind; a dataset stores their contents.
  virtual std::vector<std::string> CodeFiles() const { return {}; }
};

// A kind that makes its samplers as T(const RunConfig&).
template <class T>
class SamplerKindOf : public SamplerKind {
 public:
  std::shared_ptr<TaskSampler> Make(const RunConfig& run) const override {
    return std::make_shared<T>(run);
  }
};

// Registers a kind for all threads. Throws ArgumentError for a name that is taken, unless `replace`
// allows it.
void RegisterSampler(const std::string& kind, std::shared_ptr<const SamplerKind> sampler,
                     bool replace = false);
// Returns all kinds in alphabetical order.
std::vector<std::string> SamplerKinds();
// Returns the kind. Throws NotFoundError that lists the kinds.
std::shared_ptr<const SamplerKind> FindSamplerKind(const std::string& kind);

// Returns the sampler of a run's starts: the one that it names, else its task's.
std::shared_ptr<TaskSampler> MakeSampler(const RunConfig& run);

// Binds the task of a start to its scene unless the sampler did. The run's robot acts, or all arms
// of the scene where the run's robot is not in it.
void BindStart(EpisodeStart& start, const RunConfig& run);

}  // namespace robocell
