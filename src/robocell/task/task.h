// What an episode is about: Task judges, TaskSampler sets up, Expert acts. All three are interfaces
// that users can subclass, in C++ or Python. None of them knows of files.
//
// Frames: poses in the world unless named otherwise. Randomness only from the Rng that is handed
// in.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/base/stop.h"
#include "robocell/robot/action.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"
#include "robocell/task/refusal.h"

namespace robocell {

class Task {
 public:
  virtual ~Task() = default;
  // Remembers what success is measured from (start poses). Called once, with the scene at its start
  // state.
  virtual void Begin(const Scene& scene) = 0;
  virtual double Reward(const Scene& scene) = 0;
  virtual bool Success(const Scene& scene) = 0;
  virtual std::string instruction() const = 0;
  // Objects whose poses are worth recording.
  virtual std::vector<std::string> objects() const = 0;
};

// Where and with what an episode starts: a built scene at its start state, and its task.
struct EpisodeStart {
  Scene scene;
  std::shared_ptr<Task> task;
  std::string target_object;              // name in the scene
  std::vector<std::string> object_kinds;  // catalogue names, the target's first
  Pose base_in_world;                     // of the robot's base group
  // Places that were tried and refused on the way to this start, in the same call of Sample.
  RefusalCounts redrawn = {};
};

struct SampleResult {
  std::optional<EpisodeStart> start;
  Refusal refusal = {};
  // The target's catalogue name; "" when the sampler does not say.
  std::string object_kind() const {
    if (!start) return refusal.object_kind;
    return start->object_kinds.empty() ? "" : start->object_kinds.front();
  }
  const RefusalCounts& redrawn() const { return start ? start->redrawn : refusal.redrawn; }
};

// Which start is asked for. Samplers may use the numbers to spread their choices evenly over a run.
struct SampleRequest {
  int scene = 0;        // which scene of the source
  int episode = 0;      // which episode in that scene
  int attempt = 0;      // which try at that episode
  StopCheck stop = {};  // when it says true, the sampler may refuse with any reason
};

class TaskSampler {
 public:
  virtual ~TaskSampler() = default;
  // Same request and rng state, same start.
  virtual SampleResult Sample(const SampleRequest& request, Rng& rng) = 0;
};

class Expert {
 public:
  virtual ~Expert() = default;
  virtual void Begin(const Scene& scene, Rng& rng) = 0;
  // Called once per policy tick with the state before the action.
  virtual Action Act(const Scene& scene, Rng& rng) = 0;
  virtual bool done() const = 0;  // finished or given up
  // Why it gave up, "" otherwise. A rollout that ends with one is no success, whatever its task
  // says.
  virtual std::string failure() const = 0;
  virtual int phase() const = 0;  // index into phase_names(), for the record
  virtual std::vector<std::string> phase_names() const = 0;
};

}  // namespace robocell
