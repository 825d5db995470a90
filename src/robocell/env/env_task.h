// EnvTask: what an environment is about: a Task that also lays out the start of its episodes and
// adds to the observation. A configuration names its kind, which is registered: pick and pick_place
// are there, one's own are added before the first environment that names them is made:
//
//   RegisterEnvTask("stack", [](const EnvConfig& config, const Scene& scene) {
//     return std::make_shared<Stack>(config, scene);
//   });
//
// At a reset: Starts (before anything is moved), robots at home and bodies there, Arrange, both
// again while resting_objects() do not lie still, then Begin. After each step: Observe and Judge,
// which is Reward and Success. Objects of objects() are observed by themselves. Copies of an
// environment have a task each; their threads call them at the same time, one call at a time for
// each.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/spec/env_config.h"
#include "robocell/task/task.h"

namespace robocell {

// A part of the observation that the task adds; numbers outside of its range are cut to it.
struct TaskSignal {
  std::string name;
  std::vector<double> lower, upper;
};

// What a step is worth.
struct TaskVerdict {
  double reward = 0;
  bool success = false;
};

class EnvTask : public Task {
 public:
  // Once after each step. For tasks that find the two together.
  virtual TaskVerdict Judge(const Scene& scene) { return {Reward(scene), Success(scene)}; }

  // Where bodies start that are free or mocap bodies: poses in the world, by their names in the
  // scene. The reset puts them there with all else, which is several times as fast as moving them
  // in Arrange. The scene is still where the last episode ended: do not look at it; what depends on
  // it belongs into Arrange.
  virtual BodyPoses Starts(Rng& /*rng*/) { return {}; }
  // What else an episode starts with; the robots are at their start already. `rng` goes on from
  // Starts.
  virtual void Arrange(Scene& /*scene*/, Rng& /*rng*/) {}
  void Begin(const Scene& /*scene*/) override {}
  std::vector<std::string> objects() const override { return {}; }

  // Objects that have to lie still when an episode begins, by their ids: touching no robot, inside
  // of nothing and with something under them (scenes/start_check.h). Starts and Arrange are asked
  // again, with the numbers that follow, until they do. When the environment is made one start is
  // tried, and simulated until these objects rest.
  virtual std::vector<std::string> resting_objects() const { return {}; }

  // What it adds to the observation, asked for once, when the environment is made.
  virtual std::vector<TaskSignal> signals() const { return {}; }
  // All signals one after another into `out`.
  virtual void Observe(const Scene& /*scene*/, std::span<double> /*out*/) const {}

  // What it remembers of the episode, for going back to saved states: in the root frame, as far as
  // there are places among it, so that it holds for a rig elsewhere too.
  virtual std::vector<double> memory() const { return {}; }
  virtual void Recall(std::span<const double> /*memory*/) {}
};

// The configuration is the environment's own, the scene was compiled and not reset yet.
using EnvTaskFactory =
    std::function<std::shared_ptr<EnvTask>(const EnvConfig& config, const Scene& scene)>;

// For all environments that are made from now on, on any thread. ArgumentError for a name that is
// taken and without a function.
void RegisterEnvTask(const std::string& kind, EnvTaskFactory factory);
std::vector<std::string> EnvTaskKinds();

// The task of a configuration; null without one. NotFoundError lists the kinds.
std::shared_ptr<EnvTask> MakeEnvTask(const EnvConfig& config, const Scene& scene);

}  // namespace robocell
