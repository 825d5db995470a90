// Env: a cell of robots behind reset and step: actions and observations as flat vectors
// (env_layout.h), all poses in the shared base frame.
//
//   Env env(EnvConfig::Load("duo.yaml"));
//   env.Reset({.seed = 1});
//   std::vector<double> action(env.layout().action.size());
//   EnvStep step = env.Step(action);
//   if (step.reason == EndReason::kIkFailed) ...
//   std::span<const double> seen = env.observation();
//
// A step sends the command of every arm, independent of earlier ones, and ends when all arms have
// arrived or come to rest, when a robot collides, or when its time is up; with async_control always
// after 1/frequency. It reports the reason; motions() gives each arm's distance to its target. A
// small step to a pose without a solution nearby is made in damped steps as far as these get; if
// they make no progress the arm keeps its target, and the next command is tried again.
//
// Errors: SpecError for an invalid configuration, including task objects that do not come to rest
// where they start. ArgumentError for actions of a wrong size or with numbers that are not finite,
// before anything moves, and for a task's rewards, signals and features that are not finite;
// numbers beyond their range are clipped to it. Divergence is a value: after it, as after an error
// in the middle of a step, only Reset and Restore continue.
// With on_collision guard, a step in which a robot collides is taken back: the arms are held at
// their previous targets for the duration of the step, and the reason is collision.
// To run copies of one environment in parallel, give each its own Env on a frozen model.
// Threads: those of the scene.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/env/arm_driver.h"
#include "robocell/env/collision_monitor.h"
#include "robocell/env/env_cameras.h"
#include "robocell/env/env_layout.h"
#include "robocell/env/env_observer.h"
#include "robocell/env/env_state.h"
#include "robocell/env/object_variations.h"
#include "robocell/env/pacer.h"
#include "robocell/features/declared_features.h"
#include "robocell/scene/body_handle.h"
#include "robocell/scenes/start_inspector.h"
#include "robocell/spec/env_config.h"
#include "robocell/task/task.h"

namespace robocell {

// Reasons for the end of a step; the first that applies is reported.
enum class EndReason { kDiverged, kCollision, kIkFailed, kArrived, kSettled, kTimeout };
const char* ToString(EndReason reason);

struct EnvStep {
  EndReason reason = EndReason::kTimeout;
  double time = 0;           // simulated s since the reset
  std::string message = {};  // description of a divergence
  double reward = 0;         // reward of the task; 0 without one
  double progress = 0;       // progress of the task, 0 ... 1
  int subtask = 0;           // index of the task's subtask during the action
  bool success = false;
  std::vector<std::string> ik_failed = {};  // names of robots
  std::vector<Collision> collisions = {};   // new contacts in this step
};

struct EnvResetOptions {
  // Unset: the next seed of the stream that the last seed began; that is 0 at first, and a
  // different one for each copy of one environment.
  std::optional<uint64_t> seed = {};
  // Keyframes at which robots start instead of their homes (scene.h).
  std::optional<KeyframeChoice> keyframe = {};
};

namespace internal {
class Cell;
class PreparedObjects;
}  // namespace internal

class Env {
 public:
  explicit Env(const EnvConfig& config, const DataFactory& factory = {});
  // Uses an existing scene of EnvSceneSpec(config). `copy`: number of this copy of several. With
  // `drawing`, images are drawn when DrawFrames is called.
  Env(EnvConfig config, Scene scene, std::optional<int> copy = {},
      const std::shared_ptr<SharedDrawing>& drawing = nullptr);

  const EnvConfig& config() const { return config_; }
  const EnvLayout& layout() const { return layout_; }
  const Scene& scene() const { return scene_; }

  void Reset(const EnvResetOptions& options = {});
  // `action` has layout().action.size() numbers. Throws Error before the first Reset and after a
  // divergence. `poll` is called after each engine step, and often while a step waits for real
  // time; its exception ends the step halfway.
  EnvStep Step(std::span<const double> action, const std::function<void()>& poll = {});
  // Requires a Reset or a restored state before the next step, as after an error halfway: for
  // callers that step several environments together, when another one has failed.
  void WantReset() { phase_ = Phase::kBroken; }
  // Throws what Step would throw for this action, without moving anything.
  void RequireAction(std::span<const double> action) const;
  // Returns the observation after the last Reset or Step, layout().observation.size() numbers; a
  // step that diverged keeps the previous observation.
  std::span<const double> observation() const { return observation_; }

  // Returns each robot's remaining motion at the end of the last step, in the order of
  // layout().robots; zeros after a reset.
  const std::vector<ArmMotion>& motions() const { return motions_; }

  // Returns the last frame of each image stream.
  const std::vector<EnvFrame>& frames() const { return cameras_.frames(); }
  // Draws the pending frames; only needed with a SharedDrawing, otherwise they are already drawn.
  void DrawFrames() { cameras_.Draw(TimeSinceReset()); }
  // Returns the task in words; "" without a task.
  std::string instruction() const;

  // Saves the present state under a name. Restore goes back to it any number of times, with the
  // same continuation to the bit and the same observations; images are rendered again. Only Forget
  // removes a name. Throws NotFoundError that lists the names, and Error before the first Reset or
  // if the scene was compiled again since.
  void Save(const std::string& name);
  void Restore(const std::string& name);
  void Forget(const std::string& name);
  std::vector<std::string> saved() const;

  // Returns the present state as a value: for an environment of the same configuration, also in
  // another process, and, with StateFrame::kRoot, on a rig that stands elsewhere. Throws Error
  // before the first Reset.
  EnvState state() const;
  // Begins the task again if the state is that of a reset, and restores its memory. Throws
  // ArgumentError for a state of another configuration and for numbers that are not finite, before
  // anything changes.
  void SetState(const EnvState& state, StateFrame frame = StateFrame::kWorld);

  // Notifies an observer of all events from now on; it must be removed before it is destroyed.
  // Observers are called in the order in which they were added.
  void AddObserver(EnvObserver* observer);
  // Does nothing for an observer that was not added.
  void RemoveObserver(EnvObserver* observer);

  // Makes actions relative to the robot's present target (relative_to configured_origin). Throws
  // NotFoundError with the robots.
  void SetOriginToCurrent(const std::string& robot);

  // Return and drop the environment's only reference to the task (null without one), for owners
  // in another language. Without its task an environment cannot be used any more.
  const std::shared_ptr<Task>& task() const { return task_; }
  void DropTask();

 private:
  enum class Phase { kUnready, kReady, kDiverged, kBroken };

  struct Snapshot {
    uint64_t generation = 0;  // generation of the scene
    EnvState state;
  };

  BodyPoses TaskStarts(Rng& rng);
  void ResetToStart(const ResetOptions& options);
  void TryStart(bool is_first);
  void FindPreparedObjects(bool is_first);
  void PutPrepared(Rng& rng);
  void MakeInspector();
  std::optional<Refusal> MakeStart(uint64_t seed, const std::optional<KeyframeChoice>& keyframe,
                                   const std::vector<std::vector<double>>& kept_joints);
  std::string NoStart(const Refusal& most_often) const;
  std::string NoPlace() const;
  void RequireRest(const std::string& doubt);
  void WarnOfStart();
  std::string AdviceFor(const RobotOverlap& overlap) const;
  void RequireReady() const;
  Snapshot& RequireSnapshot(const std::string& name);
  std::vector<std::string> Send(std::span<const double> action);
  void RequireState(const EnvState& state) const;
  void RequireFrame(const EnvState& state, StateFrame frame) const;
  void RecallCell(const EnvState& state);
  void RecallOthers();
  void MoveToRoot(const Pose& from);
  using Poll = std::function<void()>;
  bool GoBack(const EnvState& before, EnvStep& out);
  int64_t TicksOfStep() const;
  double TimeSinceReset() const;
  bool ShouldEnd();
  ArmStatus StatusOfAll();
  EndReason ReasonOf(const StepResult& step, const EnvStep& out);
  bool EndsAtCollision() const;
  void Observe();
  void ReadInto(FeatureSource& source, const VectorPart& part);
  std::string place() const { return "environment '" + config_.name + "'"; }
  // Warns of arms and grippers that no action reaches.
  void RequireDistances(const ArmDriver& arm) const;
  // Returns the state without the task's memory, which a step that is taken back does not change.
  EnvState CellState() const;
  void TellUndriven(const Robot& robot) const;

  EnvConfig config_;
  Scene scene_;  // the only handle: all others here are inner() ones, as collectors rely on
  ObjectVariations variations_;
  std::shared_ptr<Task> task_;
  DeclaredFeatures signals_;  // of the task
  ChosenFeatures chosen_;
  EnvLayout layout_;
  std::vector<BodyHandle> objects_;  // bodies of layout_.objects
  std::vector<ArmDriver> arms_;
  std::shared_ptr<internal::PreparedObjects> prepared_;  // null when no place is drawn
  std::vector<std::string> resting_;                     // objects that have to rest at the start
  std::optional<StartInspector> start_inspector_;        // with such objects
  std::shared_ptr<internal::Cell> cell_;
  CollisionMonitor collisions_;
  EnvCameras cameras_;
  std::map<std::string, Snapshot> saved_;
  // Shared with the callback at control ticks, which stays in place when an Env is moved.
  std::shared_ptr<std::vector<EnvObserver*>> observers_ =
      std::make_shared<std::vector<EnvObserver*>>();
  RealTimePacer pacer_;
  Phase phase_ = Phase::kUnready;
  Rng seeds_;
  std::vector<double> observation_;
  std::vector<ArmMotion> motions_;
  int64_t ticks_ = 0;      // engine steps since the reset
  bool collided_ = false;  // true if a robot collided in this step
  bool draws_ = true;
  bool held_ = false;  // this step, by the guard
};

}  // namespace robocell
