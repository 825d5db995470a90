// Task: states the goal of an episode and judges its states. Two other roles belong to an episode:
// a TaskSampler (task_sampler.h) sets it up, and an Expert (expert/expert.h) acts. All three are
// interfaces that users can subclass, in C++ or Python, and register by name (task_kind.h,
// sampler_kind.h, expert/expert_kind.h). None of them knows of files.
//
// Poses are in the world frame unless named otherwise. Randomness only comes from the Rng that is
// passed in.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/features/declared_features.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"
#include "robocell/scenes/scene_annotations.h"
#include "robocell/task/base_placement.h"
#include "robocell/task/refusal.h"
#include "robocell/task/start_turn.h"

namespace robocell {

// Objects farther away are observed at this distance along each axis, m: they may fall for ever.
inline constexpr double kFarthestObject = 100;

// A task's judgement of a state.
struct TaskVerdict {
  double reward = 0;
  bool success = false;
  double progress = 0;  // progress: 0 at the start, 1 at success
  int subtask = 0;      // index into subtasks(), if there are several
};

// The setting of a task: a compiled scene, not reset yet, and its name in messages.
struct TaskSetting {
  std::string place;                // "environment 'duo'"
  std::vector<std::string> robots;  // names of the robots that act
  // Poses of objects in the root frame, by name, unless the task moves them.
  std::map<std::string, Pose> objects = {};
  // True in a run, which puts the robot beside the target: a start that cannot be done is drawn
  // again, with other places.
  bool is_run = false;
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
namespace internal {
class TaskCalls;  // calls the hooks (task_calls.h)
}

class Task : public DeclaresFeatures {
 public:
  // Adds objects, sites or cameras to the scene. It may be called on a Task with the same fields
  // other than the bound one: the names of what it adds follow from the fields and `rng`.
  // Objects without a pose get a place at each start; those with one stay there. What it chooses
  // among may take turns (turn()).
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
  // Refuses a start from which the task cannot be done: no grasp is in reach, nothing can be put
  // down at the goal. Another start is drawn after a refusal. Runs, which put the robot's base
  // beside the objects, call it before the objects come to rest and afterwards, environments once.
  // The state is not to be changed. grasp_check.h looks for grasps.
  virtual std::optional<Refusal> CheckStart(const Scene& /*scene*/) { return {}; }
  // Stores the values that success is measured from. The scene is in its start state.
  virtual void Begin(const Scene& /*scene*/) {}
  virtual TaskVerdict Judge(const Scene& scene) = 0;

  virtual std::string instruction() const = 0;
  // Returns the names under which the poses of objects are observed and recorded, the target first.
  virtual std::vector<std::string> objects() const { return {}; }
  // Returns the object of the scene for which a name of objects() stands in the present episode. A
  // task that draws its target among the objects of one scene (is_prepared_once) observes it as
  // "target", as in a run. Default: the object of that name.
  virtual std::string object_of(const std::string& name) const { return name; }
  // Returns the objects that have to lie still when an episode begins: touching no robot, inside of
  // nothing and with something under them (scenes/start_inspector.h). Objects whose place is drawn
  // have to as well; others, which the task itself puts somewhere, need not. A run lets them come to
  // rest first (scenes/settle.h).
  virtual std::vector<std::string> resting_objects() const { return {}; }
  // Returns the kind of an object that Prepare added: "mug" for "target". Reports count by the kind
  // of the first object, and `start.places` may name it. Default: its name.
  virtual std::string kind_of(const std::string& object) const { return object; }
  // Returns the names that TaskVerdict::subtask indexes.
  virtual std::vector<std::string> subtasks() const { return {}; }
  // Returns where the robot's base may stand around the first of objects(), for what the run or the
  // environment leaves open.
  virtual BaseRange base_range() const { return {}; }
  // Returns the objects that start on, inside or next to another one, by name, for what the run or
  // the environment leaves open. The others lie on the support.
  virtual Map<ObjectPlace> places() const { return {}; }
  // Returns why an episode whose expert has finished is not a success, in few words for counting.
  // An episode that ran out of steps counts as "timeout".
  virtual std::string why_not_done() const { return "the task was not done"; }

  // Returns the annotations of the scene that Prepare adds to: the source's (checked), else derived
  // from the geometry, which requires compiling. Available in Prepare, and afterwards if Prepare
  // read them; throws Error otherwise.
  const SceneAnnotations& annotations() const;
  // Returns whose turn it is, from Prepare on: the number of the start in its run. In an environment,
  // which is prepared once, that of the first.
  const StartTurn& turn() const { return turn_; }
  // Returns true if one scene serves all starts, as in an environment: Prepare adds everything that
  // they choose among, and each start chooses in Starts. Available as turn() is.
  bool is_prepared_once() const { return is_prepared_once_; }
  // Provides the annotations of a scene.
  using KnownScene = std::function<std::shared_ptr<const SceneAnnotations>()>;

  // Returns what the task remembers of the episode, for restoring saved states. Places in it are in
  // the root frame, so that they also hold for a rig that stands elsewhere.
  virtual std::vector<double> memory() const { return {}; }
  virtual void Recall(std::span<const double> /*memory*/) {}
  // Returns true if Recall accepts this memory. Default: it has the size of the present one.
  virtual bool CanRecall(std::span<const double> memory) const {
    return memory.size() == this->memory().size();
  }
  // Returns which number of a memory that CanRecall accepts is not one of this task, and what it may
  // be: "number 3, the target, is 99; it is a whole number from 0 to 1". "" for a good memory.
  virtual std::string WhyNotRecalled(std::span<const double> /*memory*/) const { return ""; }
  // Returns true if this memory holds for a rig that stands elsewhere.
  virtual bool HoldsElsewhere(std::span<const double> /*memory*/) const { return true; }

 private:
  friend class internal::TaskCalls;
  StartTurn turn_;
  bool is_prepared_once_ = false;
  const KnownScene* known_scene_ = nullptr;  // known scene during Prepare
  mutable std::shared_ptr<const SceneAnnotations> annotations_;
};

// Returns the task's base_range(). Throws HookError for one that is not sound (base_placement.h).
BaseRange SoundBaseRange(const Task& task);

}  // namespace robocell
