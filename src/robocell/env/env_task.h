// EnvTask: what an environment is about: a Task that also lays out the start of its episodes.
// Private to env: environments get theirs from their configuration.
#pragma once

#include <memory>

#include "robocell/base/rng.h"
#include "robocell/spec/env_config.h"
#include "robocell/task/task.h"

namespace robocell {

class EnvTask : public Task {
 public:
  // Puts the objects where the episode starts; after the robots, before Begin.
  virtual void Arrange(Scene& scene, Rng& rng) = 0;
  // A copy that remembers the same start.
  virtual std::unique_ptr<EnvTask> Clone() const = 0;
};

// The task of a configuration; null without one. ArgumentError when its object cannot move.
std::unique_ptr<EnvTask> MakeEnvTask(const EnvConfig& config, const Scene& scene);

}  // namespace robocell
