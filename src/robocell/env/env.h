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
// A step sends the command of every arm, whatever was sent before, and ends when all have arrived
// or come to rest, when a robot runs into something, or when its time is up; with async_control
// always after 1/frequency. It says which; motions() says how far each arm is from its target. A
// small step to a pose without a solution nearby is made in damped steps as far as these get; where
// they get nowhere the arm keeps its target, and the next command is tried anew.
//
// Errors: SpecError for what is wrong with the configuration, objects of the task included that do
// not come to rest where they start; ArgumentError for actions of a wrong size or with numbers that
// are not finite, before anything moves, and for rewards of a task, signals and features that are
// not finite; numbers beyond their range are cut to it. Divergence is a value: after it, as after an
// error on the way, only Reset and Restore go on. With on_collision guard a step is simulated, and
// when a robot runs into something, taken back: the arms are held where they were
// sent before, for as long as the step takes, and the reason is collision. Copies of one
// environment run in parallel each with an Env of its own on a frozen model. Threads: those of the
// scene.
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
#include "robocell/env/stepper.h"
#include "robocell/features/declared_features.h"
#include "robocell/scene/body_handle.h"
#include "robocell/scenes/start_inspector.h"
#include "robocell/spec/env_config.h"
#include "robocell/task/task.h"

namespace robocell {

// Why a step ended: the first of these that is so.
enum class EndReason { kDiverged, kCollision, kIkFailed, kArrived, kSettled, kTimeout };
const char* ToString(EndReason reason);

struct EnvStep {
  EndReason reason = EndReason::kTimeout;
  double time = 0;           // simulated s since the reset
  std::string message = {};  // of a divergence
  double reward = 0;         // of the task, 0 without
  double progress = 0;       // of the task, 0 ... 1
  int subtask = 0;           // which of the task's the action worked at
  bool success = false;
  std::vector<std::string> ik_failed = {};  // robots
  std::vector<Collision> collisions = {};   // what touched in this step
};

struct EnvResetOptions {
  // Unset: the next of the stream that the last seed began; 0 at first, and for copies of one
  // environment another one for each.
  std::optional<uint64_t> seed = {};
  // What robots start at in place of their homes (scene.h).
  std::optional<KeyframeChoice> keyframe = {};
};

namespace internal {
class PreparedObjects;
}

class Env {
 public:
  explicit Env(const EnvConfig& config, const DataFactory& factory = {});
  // In a scene that was made before, of EnvSceneSpec(config).
  // `copy`: which of several this is. With `drawing` images are taken when DrawFrames is called.
  Env(EnvConfig config, Scene scene, std::optional<int> copy = {},
      const std::shared_ptr<SharedDrawing>& drawing = nullptr);

  const EnvConfig& config() const { return config_; }
  const EnvLayout& layout() const { return layout_; }
  const Scene& scene() const { return scene_; }

  void Reset(const EnvResetOptions& options = {});
  // `action` has layout().action.size() numbers. Error before the first Reset and after a
  // divergence. `poll` is called after each step of the engine, and often while a step waits for
  // real time; what it throws ends the step halfway.
  EnvStep Step(std::span<const double> action, const std::function<void()>& poll = {});
  // From now on only Reset and going back to a state go on, as after an error halfway: for those
  // who step several environments together, when that of another one has failed.
  void WantReset() { phase_ = Phase::kBroken; }
  // Throws what Step would throw for this action, and moves nothing.
  void RequireAction(std::span<const double> action) const;
  // What the last Reset or Step left, layout().observation.size() numbers; a step that diverged
  // leaves what was before it.
  std::span<const double> observation() const { return observation_; }

  // What was left of each robot's motion when the last step ended, in the order of layout().robots;
  // zeros after a reset.
  const std::vector<ArmMotion>& motions() const { return motions_; }

  // The last frame of each image stream.
  const std::vector<EnvFrame>& frames() const { return cameras_.frames(); }
  // Draws what is due; only with a SharedDrawing, else it is drawn already.
  void DrawFrames() { cameras_.Draw(TimeSinceReset()); }
  // What the task is, in words; "" without one.
  std::string instruction() const { return task_ ? task_->instruction() : ""; }

  // Keeps the present state under a name, and goes back to it as often as wished: what follows is
  // the same to the bit. Observations are those of then; images are taken anew. Names are forgotten
  // by nothing but Forget. NotFoundError lists the names, Error before the first Reset and in a
  // scene that was compiled anew since.
  void Save(const std::string& name);
  void Restore(const std::string& name);
  void Forget(const std::string& name);
  std::vector<std::string> saved() const;

  // The present state as a value: for an environment of the same configuration, in another process
  // too, and with StateFrame::kRoot of a rig that stands elsewhere. Error before the first Reset.
  EnvState state() const;
  // ArgumentError for a state of another configuration and for numbers that are not finite, before
  // anything changes.
  void SetState(const EnvState& state, StateFrame frame = StateFrame::kWorld);

  // From now on an observer hears of all that happens; it must outlive the environment, or be
  // removed before. In the order in which they were added.
  void AddObserver(EnvObserver* observer);
  // Does nothing for one that was not added.
  void RemoveObserver(EnvObserver* observer);

  // With relative_to configured_origin: from now on relative to where the robot was last sent.
  // NotFoundError lists the robots.
  void SetOriginToCurrent(const std::string& robot);

  // For those who own the task's object in another language: the only reference to it from here,
  // null without one, and its end. Without its task an environment is of no use any more.
  const std::shared_ptr<Task>& task() const { return task_; }
  void DropTask() { task_.reset(); }

 private:
  enum class Phase { kUnready, kReady, kDiverged, kBroken };

  struct Snapshot {
    uint64_t generation = 0;  // of the scene
    EnvState state;
  };

  void TryStart(bool is_first);
  void FindPreparedObjects(bool is_first);
  void PutPrepared(Rng& rng);
  void MakeInspector();
  std::string MakeStart(uint64_t seed, const std::optional<KeyframeChoice>& keyframe,
                        const std::vector<std::vector<double>>& kept_joints);
  std::string NoStart(const std::string& why) const;
  std::string NoPlace() const;
  void RequireRest(const std::string& doubt);
  void WarnOfStart();
  void RequireReady() const;
  Snapshot& RequireSnapshot(const std::string& name);
  std::vector<std::string> Send(std::span<const double> action);
  void RequireState(const EnvState& state) const;
  void Recall(const EnvState& state);
  void MoveToRoot(const Pose& from);
  using Poll = std::function<void()>;
  StepResult Advance(const Poll& poll);
  StepResult AdvanceGuarded(std::span<const double> action, const EnvState& before, EnvStep& out,
                            const Poll& poll);
  void Judge(EnvStep& out);
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
  void TellUndriven(const Robot& robot) const;

  EnvConfig config_;
  Scene scene_;
  ObjectVariations variations_;
  std::shared_ptr<Task> task_;
  DeclaredFeatures signals_;  // of the task
  ChosenFeatures chosen_;
  EnvLayout layout_;
  std::vector<BodyHandle> objects_;  // of layout_.objects
  std::vector<ArmDriver> arms_;
  std::shared_ptr<internal::PreparedObjects> prepared_;  // null when no place is drawn
  std::vector<std::string> resting_;                     // objects that have to rest at the start
  std::optional<StartInspector> start_inspector_;        // with such objects
  Stepper stepper_;
  CollisionMonitor collisions_;
  EnvCameras cameras_;
  std::map<std::string, Snapshot> saved_;
  // Shared with what is called at control ticks, which stays as it is when an Env is moved.
  std::shared_ptr<std::vector<EnvObserver*>> observers_ =
      std::make_shared<std::vector<EnvObserver*>>();
  RealTimePacer pacer_;
  Phase phase_ = Phase::kUnready;
  Rng seeds_;
  std::vector<double> observation_;
  std::vector<ArmMotion> motions_;
  int64_t ticks_ = 0;      // engine steps since the reset
  bool collided_ = false;  // in this step
  bool draws_ = true;
  bool held_ = false;  // this step, by the guard
};

}  // namespace robocell
