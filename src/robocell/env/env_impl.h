// Env::State: the parts of an environment (env.h), and the functions behind its reset, steps and
// states. env.cc makes steps, env_start.cc begins episodes, env_state.cc saves and restores states.
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
#include "robocell/env/cell.h"
#include "robocell/env/collision_monitor.h"
#include "robocell/env/env.h"
#include "robocell/env/env_cameras.h"
#include "robocell/env/object_variations.h"
#include "robocell/env/pacer.h"
#include "robocell/env/prepared_objects.h"
#include "robocell/features/cell_features.h"
#include "robocell/features/chosen_features.h"
#include "robocell/features/declared_features.h"
#include "robocell/features/observed_object.h"
#include "robocell/robot/action.h"
#include "robocell/scenes/randomization.h"
#include "robocell/scenes/start_inspector.h"
#include "robocell/spec/randomize_config.h"

namespace robocell {

class Env::State {
 public:
  using Poll = std::function<void()>;

  State(EnvConfig config, Scene scene, std::optional<int> copy,
        const std::shared_ptr<internal::SharedDrawing>& drawing);
  State(const State&) = delete;  // the cell calls its observers
  State& operator=(const State&) = delete;

  const EnvConfig& config() const { return config_; }
  const EnvLayout& layout() const { return layout_; }
  const Scene& scene() const { return scene_; }
  std::span<const double> observation() const { return observation_; }
  const std::vector<ArmMotion>& motions() const { return motions_; }
  const internal::EnvCameras& cameras() const { return cameras_; }
  const std::shared_ptr<Task>& task() const { return task_; }

  // The functions of Env.
  void Reset(const EnvResetOptions& options);
  EnvStep Step(std::span<const double> action, const Poll& poll);
  EnvStep Act(const std::map<std::string, std::vector<double>>& commands, const Poll& poll);
  void WantReset() { phase_ = Phase::kBroken; }
  void RequireAction(std::span<const double> action) const;
  Action RequireCommands(const std::map<std::string, std::vector<double>>& commands);
  CellFeatures& features();
  void DrawFrames() { cameras_.Draw(TimeSinceReset()); }
  std::string instruction() const;
  const RandomizedValues& randomized() const;
  void Save(const std::string& name);
  void Restore(const std::string& name);
  void Forget(const std::string& name);
  std::vector<std::string> saved() const;
  EnvState state() const;
  void SetState(const EnvState& state, StateFrame frame);
  void AddObserver(EnvObserver* observer);
  void RemoveObserver(EnvObserver* observer);
  void SetOriginToCurrent(const std::string& robot);
  void DropTask();

 private:
  enum class Phase { kUnready, kReady, kDiverged, kBroken };

  // Seeds of randomize are whole numbers below this one: a state keeps them as numbers.
  static constexpr double kRandomizationSeeds = 4294967296.0;

  struct Snapshot {
    uint64_t generation = 0;  // generation of the scene
    EnvState state;
  };

  void Randomize(double seed);
  std::vector<double> DrawnVariations() const;
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
  std::string AdviceFor(const internal::RobotOverlap& overlap) const;
  void RequireReady() const;
  Snapshot& RequireSnapshot(const std::string& name);
  // Sends the commands, and returns the names of robots whose pose has no solution.
  using SendCommands = std::function<std::vector<std::string>()>;
  std::vector<std::string> Send(std::span<const double> action);
  std::vector<std::string> Send(Action action);
  EnvStep Make(const SendCommands& send, const Poll& poll);
  void RequireState(const EnvState& state) const;
  void RequireFrame(const EnvState& state, StateFrame frame) const;
  void RecallCell(const EnvState& state);
  void RecallOthers();
  void MoveToRoot(const Pose& from);
  bool GoBack(const EnvState& before, EnvStep& out);
  int64_t TicksOfStep() const;
  double TimeSinceReset() const;
  bool ShouldEnd();
  internal::ArmStatus StatusOfAll();
  EndReason ReasonOf(const StepResult& step, const EnvStep& out);
  bool EndsAtCollision() const;
  void Observe();
  void ReadInto(FeatureSource& source, const VectorPart& part);
  std::string place() const { return "environment '" + config_.name + "'"; }
  void RequireDistances(const internal::ArmDriver& arm) const;
  // Returns the state without the task's memory, which a step that is taken back does not change.
  EnvState CellState() const;
  // Warns of arms and grippers that no action reaches.
  void WarnOfUndriven(const Robot& robot) const;
  // Warns if actions are poses that its arm cannot all take.
  void WarnOfFewJoints(const Robot& robot) const;

  EnvConfig config_;
  Scene scene_;  // all other handles here are inner() ones: garbage collectors rely on that
  internal::ObjectVariations variations_;
  std::optional<internal::Randomization> randomization_;  // if the configuration has it
  double randomization_seed_ = -1;  // its values follow from it; -1 before it was drawn
  // With `every: scene` that of all resets; drawn in the first one.
  std::optional<double> scene_randomization_seed_;
  std::shared_ptr<Task> task_;
  DeclaredFeatures signals_;  // of the task
  internal::ChosenFeatures chosen_;
  EnvLayout layout_;
  std::vector<ObservedObject> objects_;  // those of layout_.objects
  std::vector<internal::ArmDriver> arms_;
  std::optional<internal::PreparedObjects> prepared_;  // unset when no place is drawn
  std::vector<std::string> resting_;                   // objects that have to rest at the start
  std::optional<internal::StartInspector> start_inspector_;  // with such objects
  internal::Cell cell_;
  internal::CollisionMonitor collisions_;
  internal::EnvCameras cameras_;
  std::map<std::string, Snapshot> saved_;
  std::vector<EnvObserver*> observers_;
  std::optional<CellFeatures> features_;  // of this episode; made at the first use
  internal::RealTimePacer pacer_;
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
