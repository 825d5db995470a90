// The roles in an episode: Task states and judges the goal, TaskSampler sets up, Expert acts. All
// three are interfaces that users can subclass, in C++ or Python, and register by name
// (task_kind.h, expert/expert_kind.h). None of them knows of files.
//
// Poses are in the world frame unless named otherwise. Randomness only comes from the Rng that is
// passed in.
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

// A task's judgement of a state.
struct TaskVerdict {
  double reward = 0;
  bool success = false;
  double progress = 0;  // from 0 at the start to 1 at success
  int subtask = 0;      // index into subtasks(), if there are several
};

// The setting of a task: a compiled scene, not reset yet, and its name in messages.
struct TaskSetting {
  std::string place;                // "environment 'duo'"
  std::vector<std::string> robots;  // names of the robots that act
  // Poses of objects in the root frame, by name, unless the task moves them.
  std::map<std::string, Pose> objects = {};
};

// The goal of the robots. The same class serves environments, generated datasets and evaluation.
//
// A scene has to contain the task's objects: Prepare adds them to the scene's spec. Bind follows
// once the scene is compiled. Each episode begins with Starts, a reset that puts robots at home and
// bodies at these starts, and Arrange (all of them again while resting_objects() do not lie still),
// and then Begin. Each step is followed by Judge and Observe. Each copy of an environment has its
// own task; threads call different tasks at the same time, but one task by one call at a time. A
// restored state is followed by Recall, and one that a reset had just made by Begin before.
//
// A task declares its contributions to the observation as signals(), which Observe reads
// (features/declared_features.h).
class Task : public DeclaresFeatures {
 public:
  // Adds objects, sites or cameras to the scene. It may be called on a Task with the same fields
  // other than the bound one: the names of what it adds follow from the fields and `rng`.
  // Objects without a pose get a place at each start; those with one stay there.
  virtual void Prepare(SceneSpec& /*spec*/, Rng& /*rng*/) {}
  virtual void Bind(const Scene& /*scene*/, const TaskSetting& /*setting*/) {}

  // Returns where free and mocap bodies start: poses in the world, by their names in the scene. The
  // reset puts them there with everything else, which is several times as fast as moving them in
  // Arrange. The scene is still in the last state of the previous episode: do not read it; what
  // depends on the scene belongs in Arrange.
  virtual BodyPoses Starts(Rng& /*rng*/) { return {}; }
  // Arranges the rest of the start; the robots are at their start already. `rng` continues from
  // Starts. A refusal discards this start, and another one is drawn.
  virtual std::optional<Refusal> Arrange(Scene& /*scene*/, Rng& /*rng*/) { return {}; }
  // Stores the values that success is measured from. The scene is in its start state.
  virtual void Begin(const Scene& /*scene*/) {}
  virtual TaskVerdict Judge(const Scene& scene) = 0;

  virtual std::string instruction() const = 0;
  // Returns the names of the objects whose poses are observed and recorded, the target first.
  virtual std::vector<std::string> objects() const { return {}; }
  // Returns the objects that have to lie still when an episode begins: touching no robot, inside of
  // nothing and with something under them (scenes/start_inspector.h).
  virtual std::vector<std::string> resting_objects() const { return {}; }
  // Returns the names that TaskVerdict::subtask indexes.
  virtual std::vector<std::string> subtasks() const { return {}; }
  // Returns where the robot's base may stand around the first of objects(), for what the run or the
  // environment leaves open.
  virtual BaseRange base_range() const { return {}; }
  // Returns the objects that start on, inside or next to another one, by name, for what the run or
  // the environment leaves open. The others lie on the support.
  virtual Map<ObjectPlace> places() const { return {}; }
  // Returns why an episode whose expert has finished is no success, in few words for counting. An
  // episode that ran out of steps counts as "timeout".
  virtual std::string why_not_done() const { return "the task was not done"; }

  // What is known of the scene that Prepare adds to: what its source says, checked, else what
  // follows from its geometry, which is compiled when this is asked. Prepare asks first; the same is
  // there afterwards. Error when it did not.
  const SceneAnnotations& annotations() const;
  // How the annotations of a scene are found.
  using KnownScene = std::function<std::shared_ptr<const SceneAnnotations>()>;
  // Prepare, with these annotations: for those who make scenes.
  void PrepareIn(const KnownScene& known, SceneSpec& spec, Rng& rng);

  // Returns what the task remembers of the episode, for restoring saved states. Places in it are in
  // the root frame, so that they also hold for a rig that stands elsewhere.
  virtual std::vector<double> memory() const { return {}; }
  virtual void Recall(std::span<const double> /*memory*/) {}
  // Returns true if Recall accepts this memory. Default: it has the size of the present one.
  virtual bool CanRecall(std::span<const double> memory) const {
    return memory.size() == this->memory().size();
  }
  // Returns true if this memory holds for a rig that stands elsewhere.
  virtual bool HoldsElsewhere(std::span<const double> /*memory*/) const { return true; }

 private:
  const KnownScene* known_scene_ = nullptr;  // while it prepares
  mutable std::shared_ptr<const SceneAnnotations> annotations_;
};

// Returns the task's base_range(). Throws HookError for one that is not sound (base_placement.h).
BaseRange SoundBaseRange(const Task& task);

// The record of a state before an action: numbers and images, which are valid during the call that
// receives them.
struct CellRow {
  const FeatureSchema& observed;
  std::span<const double> numbers;  // of `observed`, one after another
  const CellImages& images;
};

// How an episode starts: a built scene in its start state, and its task.
struct EpisodeStart {
  Scene scene;
  std::shared_ptr<Task> task;
  std::string target_object;              // name in the scene
  std::vector<std::string> object_kinds;  // catalogue names, the target's first
  Pose base_in_world;                     // of the robot's base group
  // Places refused on the way to this start, in the same call of Sample.
  RefusalCounts redrawn = {};
  // True if the sampler has bound the task; else the code that runs the episode binds it
  // (BindStart).
  bool is_bound = false;
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
  int scene = 0;          // which scene of the source
  int episode = 0;        // number of the episode in that scene
  int attempt = 0;        // number of the attempt at that episode
  StopRequest stop = {};  // once it returns true, the sampler may refuse with any reason
};

class TaskSampler : public Hooks {
 public:
  // The same request and rng state give the same start.
  virtual SampleResult Sample(const SampleRequest& request, Rng& rng) = 0;
  // Adds what is known to be wrong with its starts before the first one, at the fields of the run.
  // `scenes`: numbers of the run's scenes, of those that are alike one.
  virtual void ValidateStarts(std::span<const int> /*scenes*/, Problems& /*problems*/) {}
};

class Expert : public Hooks {
 public:
  virtual void Begin(const Scene& scene, Rng& rng) = 0;
  // Receives, before each Act, what is recorded of the state: for policies that act from that
  // alone.
  virtual void See(const CellRow& /*row*/) {}
  // Returns the action of one policy tick for the present state.
  virtual Action Act(const Scene& scene, Rng& rng) = 0;
  virtual bool done() const = 0;  // finished or given up
  // Returns why it gave up, "" otherwise. A rollout that ends with a failure is no success,
  // whatever its task says.
  virtual std::string failure() const = 0;
  // Returns true if a rollout ends as soon as the task is done: for policies, which do not know it.
  virtual bool ends_at_success() const { return false; }
  virtual int phase() const = 0;  // index into phase_names(), for the record
  virtual std::vector<std::string> phase_names() const = 0;
};

}  // namespace robocell
