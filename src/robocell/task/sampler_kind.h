// The kinds of samplers: where episodes start, by names that a run file may say (`sampler: ...`) in
// the place of its task's own sampler. One's own are registered like tasks and experts:
//
//   RegisterSampler("on_the_floor", std::make_shared<SamplerKindOf<OnTheFloor>>());
//
// Includes nothing of a concrete sampler; what runs tasks includes this file.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "robocell/spec/run_config.h"
#include "robocell/task/task.h"

namespace robocell {

class SamplerKind {
 public:
  virtual ~SamplerKind() = default;
  virtual std::shared_ptr<TaskSampler> Make(const RunConfig& run) const = 0;
  // Source files that define it, for kinds that users write: a dataset remembers what they held.
  virtual std::vector<std::string> CodeFiles() const { return {}; }
};

// A kind whose samplers are made as T(const RunConfig&).
template <class T>
class SamplerKindOf : public SamplerKind {
 public:
  std::shared_ptr<TaskSampler> Make(const RunConfig& run) const override {
    return std::make_shared<T>(run);
  }
};

// Makes a kind known on all threads, from now on. ArgumentError for a name that is taken, unless
// `replace` allows it.
void RegisterSampler(const std::string& kind, std::shared_ptr<const SamplerKind> sampler,
                     bool replace = false);
// All kinds, in alphabetical order.
std::vector<std::string> SamplerKinds();
// NotFoundError lists the kinds.
std::shared_ptr<const SamplerKind> FindSamplerKind(const std::string& kind);

// The sampler of a run's starts: the one that it names, else its task's.
std::shared_ptr<TaskSampler> MakeSampler(const RunConfig& run);

// Binds the task of a start to its scene unless the sampler did. It acts with the run's robot, or
// with all arms of the scene where that is none of them.
void BindStart(EpisodeStart& start, const RunConfig& run);

}  // namespace robocell
