// TaskSampler: decides where episodes start. It makes EpisodeStarts one by one, or refuses. Users can
// subclass it, in C++ or Python, and register it by name (sampler_kind.h); StartSampler
// (start_sampler.h) makes starts of any task stage by stage.
//
//   const SampleResult sample = sampler.Sample({.scene = 0, .episode = 3, .attempt = 1}, rng);
//   if (sample.start) ...   // else sample.refusal says why there is none
//
// Randomness only comes from the Rng that is passed in.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "robocell/base/hook_error.h"
#include "robocell/base/rng.h"
#include "robocell/base/stop.h"
#include "robocell/math/pose.h"
#include "robocell/scene/scene.h"
#include "robocell/spec/problems.h"
#include "robocell/spec/randomize_config.h"
#include "robocell/task/refusal.h"
#include "robocell/task/task.h"

namespace robocell {

class Robot;
class SceneSource;

// Start of an episode: a built scene in its start state, and its task.
struct EpisodeStart {
  Scene scene;
  std::shared_ptr<Task> task;
  std::string target_object;              // name in the scene
  std::vector<std::string> object_kinds;  // catalogue names, the target's first
  Pose base_in_world;                     // pose of the robot's base group
  // Places refused on the way to this start, in the same call of Sample.
  RefusalCounts redrawn = {};
  // True if the sampler has bound the task; else the code that runs the episode binds it
  // (BindStart).
  bool is_bound = false;
  // The values of `randomize:`: from the sampler those of its clutter, later all of them.
  RandomizedValues randomized = {};
  // Takes them out of the scene's model when the start ends; null without any.
  std::shared_ptr<void> randomization = {};
};

struct SampleResult {
  std::optional<EpisodeStart> start;
  Refusal refusal = {};
  // Returns the target's catalogue name; "" if the sampler sets none.
  std::string object_kind() const {
    if (!start) return refusal.object_kind;
    return start->object_kinds.empty() ? "" : start->object_kinds.front();
  }
  const RefusalCounts& redrawn() const { return start ? start->redrawn : refusal.redrawn; }
};

// The requested start. Samplers may use the numbers to spread their choices evenly over a run.
struct SampleRequest {
  int scene = 0;          // index of the scene in the source
  int episode = 0;        // number of the episode in that scene
  int attempt = 0;        // number of the attempt at that episode
  StopRequest stop = {};  // once it returns true, the sampler may refuse with any reason
  // Makes the data of the start's scene: samplers pass it to Scene::Build. Hooks of another language
  // may need data that is theirs.
  DataFactory scene_data = {};
};

class TaskSampler : public Hooks {
 public:
  // The same request and rng state give the same start.
  virtual SampleResult Sample(const SampleRequest& request, Rng& rng) = 0;
  // Adds what is known to be wrong with its starts before the first one, at the fields of the run.
  // `scenes`: numbers of the run's scenes, of those that are alike one.
  virtual void ValidateStarts(std::span<const int> /*scenes*/, Problems& /*problems*/) {}
  // For an owner that keeps the source of scenes as an object of another language: gives access to
  // the only reference from here (null without a source), and drops it. After that no start can be
  // sampled.
  virtual const std::shared_ptr<SceneSource>& source() const {
    static const std::shared_ptr<SceneSource> none;
    return none;
  }
  virtual void DropSource() {}
  // Adds problems of the range from which it draws the robot's base, for samplers that draw it from
  // one: a range beyond the robot's reach refuses every start.
  virtual void ValidateBaseRange(const Robot& /*robot*/, Problems& /*problems*/) {}
};

}  // namespace robocell
