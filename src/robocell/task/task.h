// What an episode is about: Task says what is to be done and judges, TaskSampler sets up, Expert
// acts. All three are interfaces that users can subclass, in C++ or Python, and register by a name
// (task_kind.h, expert/expert_kind.h). None of them knows of files.
//
// Frames: poses in the world unless named otherwise. Randomness only from the Rng that is handed
// in.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "robocell/base/hook_error.h"
#include "robocell/base/rng.h"
#include "robocell/base/stop.h"
#include "robocell/data/feature_schema.h"
#include "robocell/features/cell_images.h"
#include "robocell/features/declared_features.h"
#include "robocell/robot/action.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"
#include "robocell/scenes/scene_annotations.h"
#include "robocell/spec/problems.h"
#include "robocell/task/base_placement.h"
#include "robocell/task/refusal.h"

namespace robocell {

// Objects farther away are observed at this distance along each axis, m: they may fall for ever.
inline constexpr double kFarthestObject = 100;

// What a state is worth.
struct TaskVerdict {
  double reward = 0;
  bool success = false;
  double progress = 0;  // from 0 at the start to 1 at success
  int subtask = 0;      // index into subtasks(), with several of them
};

// What a task is about: a compiled scene, which was not reset yet, and how it is called in messages.
struct TaskSetting {
  std::string place;                // "environment 'duo'"
  std::vector<std::string> robots;  // names of those that act
  // Where objects stand in the root frame unless the task moves them, by name.
  std::map<std::string, Pose> objects = {};
};

// What robots are to do. The same class serves environments, generated datasets and evaluation.
//
// A scene has to hold what the task is about: Prepare adds it to the scene's spec. Bind follows
// once the scene is compiled. Each episode begins with Starts, a reset that puts robots at home and
// bodies there, Arrange, both again while resting_objects() do not lie still, and Begin. After each
// step come Judge and Observe. Copies of an environment have a task each; their threads call them
// at the same time, one call at a time for each.
//
// What it adds to the observation it declares as signals(), read by Observe
// (features/declared_features.h).
class Task : public DeclaresFeatures {
 public:
  // Adds objects, sites or cameras to the scene. It may be called on another Task of the same
  // fields than the one that is bound: the names of what it adds follow from fields and `rng`.
  // Objects without a pose get a place at each start; those with one stay there.
  virtual void Prepare(SceneSpec& /*spec*/, Rng& /*rng*/) {}
  virtual void Bind(const Scene& /*scene*/, const TaskSetting& /*setting*/) {}

  // Where free and mocap bodies start: poses in the world, by their names in the scene. The reset
  // puts them there with all else, which is several times as fast as moving them in Arrange. The
  // scene is still where the last episode ended: do not look at it; what depends on it belongs into
  // Arrange.
  virtual BodyPoses Starts(Rng& /*rng*/) { return {}; }
  // Does what else an episode starts with; the robots are at their start already. `rng` goes on
  // from Starts. A refusal ends this start, and another one is drawn.
  virtual std::optional<Refusal> Arrange(Scene& /*scene*/, Rng& /*rng*/) { return {}; }
  // Remembers what success is measured from. The scene is at its start state.
  virtual void Begin(const Scene& /*scene*/) {}
  virtual TaskVerdict Judge(const Scene& scene) = 0;

  virtual std::string instruction() const = 0;
  // Names of the objects whose poses are observed and recorded, what the task is about first.
  virtual std::vector<std::string> objects() const { return {}; }
  // Objects that have to lie still when an episode begins: touching no robot, inside of nothing and
  // with something under them (scenes/start_check.h).
  virtual std::vector<std::string> resting_objects() const { return {}; }
  // What TaskVerdict::subtask counts through.
  virtual std::vector<std::string> subtasks() const { return {}; }
  // In runs: where the robot's base may stand around the first of objects(), as far as `start` of
  // the run does not say.
  virtual BaseRange base_range() const { return {}; }
  // In runs: objects that start on, inside or next to something, by their names, as far as
  // `start.places` of the run does not say. The others lie on the support.
  virtual Map<ObjectPlace> places() const { return {}; }
  // Why an episode whose expert has finished is no success, in few words for counting. One that ran
  // out of steps counts as "timeout".
  virtual std::string why_not_done() const { return "the task was not done"; }

  // What is known of the scene that Prepare adds to: what its source says, checked, else what
  // follows from its geometry, which is compiled when this is asked. Prepare asks first; the same is
  // there afterwards. Error when it did not.
  const SceneAnnotations& annotations() const;
  // How the annotations of a scene are found.
  using KnownScene = std::function<std::shared_ptr<const SceneAnnotations>()>;
  // Prepare, with these annotations: for those who make scenes.
  void PrepareIn(const KnownScene& known, SceneSpec& spec, Rng& rng);

  // What it remembers of the episode, for going back to saved states: in the root frame, as far as
  // there are places among it, so that it holds for a rig elsewhere too.
  virtual std::vector<double> memory() const { return {}; }
  virtual void Recall(std::span<const double> /*memory*/) {}

 private:
  const KnownScene* known_scene_ = nullptr;  // while it prepares
  mutable std::shared_ptr<const SceneAnnotations> annotations_;
};

// What is recorded of a state before an action: numbers and images, which live as long as the call
// that gets them.
struct CellRow {
  const FeatureSchema& observed;
  std::span<const double> numbers;  // of `observed`, one after another
  const CellImages& images;
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
  // Whether the sampler has bound the task; else who runs the episode does (BindStart).
  bool is_bound = false;
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
  int scene = 0;          // which scene of the source
  int episode = 0;        // which episode in that scene
  int attempt = 0;        // which try at that episode
  StopRequest stop = {};  // when it says true, the sampler may refuse with any reason
};

class TaskSampler : public Hooks {
 public:
  // Same request and rng state, same start.
  virtual SampleResult Sample(const SampleRequest& request, Rng& rng) = 0;
  // Adds what is known to be wrong with its starts before the first one, at the fields of the run.
  // `scenes`: numbers of the run's scenes, of those that are alike one.
  virtual void ValidateStarts(std::span<const int> /*scenes*/, Problems& /*problems*/) {}
};

class Expert : public Hooks {
 public:
  virtual void Begin(const Scene& scene, Rng& rng) = 0;
  // Called before each Act with what is recorded of the state: for those who act from that alone.
  virtual void See(const CellRow& /*row*/) {}
  // Called once per policy tick with the state before the action.
  virtual Action Act(const Scene& scene, Rng& rng) = 0;
  virtual bool done() const = 0;  // finished or given up
  // Why it gave up, "" otherwise. A rollout that ends with one is no success, whatever its task
  // says.
  virtual std::string failure() const = 0;
  // Whether a rollout ends as soon as the task is done: for policies, which do not know it.
  virtual bool ends_at_success() const { return false; }
  virtual int phase() const = 0;  // index into phase_names(), for the record
  virtual std::vector<std::string> phase_names() const = 0;
};

}  // namespace robocell
