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

#include "robocell/env/env_layout.h"
#include "robocell/env/env_observer.h"
#include "robocell/env/env_state.h"
#include "robocell/env/env_step.h"
#include "robocell/features/cell_images.h"
#include "robocell/scene/scene.h"
#include "robocell/spec/env_config.h"
#include "robocell/spec/randomize_config.h"
#include "robocell/task/task.h"

namespace robocell {

class CellFeatures;
namespace internal {
struct SharedDrawing;
}

struct EnvResetOptions {
  // Unset: the next seed of the stream that the last seed began; that is 0 at first, and a
  // different one for each copy of one environment.
  std::optional<uint64_t> seed = {};
  // Keyframes at which robots start instead of their homes (scene.h).
  std::optional<KeyframeChoice> keyframe = {};
};

class Env {
 public:
  explicit Env(const EnvConfig& config, const DataFactory& factory = {});
  // Uses an existing scene of EnvSceneSpec(config). `copy`: number of this copy of several. With
  // `drawing`, images are drawn when DrawFrames is called.
  Env(EnvConfig config, Scene scene, std::optional<int> copy = {},
      const std::shared_ptr<internal::SharedDrawing>& drawing = nullptr);
  ~Env();
  Env(Env&&) noexcept;

  const EnvConfig& config() const;
  const EnvLayout& layout() const;
  const Scene& scene() const;

  // Throws NotFoundError for a keyframe that no robot has, before anything changes.
  void Reset(const EnvResetOptions& options = {});
  // `action` has layout().action.size() numbers. Throws Error before the first Reset and after a
  // divergence. `poll` is called after each engine step, and often while a step waits for real
  // time; its exception ends the step halfway.
  EnvStep Step(std::span<const double> action, const std::function<void()>& poll = {});
  // The same with commands by the names of features().commanded(), which are the names of action
  // columns in datasets: {{"robots/left/action/arm", q}}. Groups without a command keep their
  // target. Limits of actions and binary_gripper do not apply: the recorded
  // targets of an episode give its states again, to the bit. Throws NotFoundError with the nearest
  // names, and ArgumentError for two commands of one group, before anything moves.
  EnvStep Act(const std::map<std::string, std::vector<double>>& commands,
              const std::function<void()>& poll = {});
  // Requires a Reset or a restored state before the next step, as after an error halfway: for
  // callers that step several environments together, when another one has failed.
  void WantReset();
  // Throws what Step would throw for this action, without moving anything.
  void RequireAction(std::span<const double> action) const;
  // Throws what Act would throw for these commands, without moving anything.
  void RequireCommands(const std::map<std::string, std::vector<double>>& commands);
  // Returns the observation after the last Reset or Step, layout().observation.size() numbers; a
  // step that diverged keeps the previous observation.
  std::span<const double> observation() const;
  // Returns the features of the cell under the names that datasets have, for observations of the
  // present state and for Act; valid until the next Reset.
  CellFeatures& features();

  // Returns each robot's remaining motion at the end of the last step, in the order of
  // layout().robots; zeros after a reset.
  const std::vector<ArmMotion>& motions() const;

  // Returns the last frame of each image stream, with the time since the reset at which it was
  // taken. Images that the stream does not take are empty.
  const std::vector<CellImage>& frames() const;
  // Draws the pending frames; only needed with a SharedDrawing, otherwise they are already drawn.
  void DrawFrames();
  // Returns the task in words; "" without a task.
  std::string instruction() const;
  // Returns the values that `randomize` drew for this episode; empty without it.
  const RandomizedValues& randomized() const;

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
  const std::shared_ptr<Task>& task() const;
  void DropTask();

 private:
  class State;
  std::unique_ptr<State> state_;
};

}  // namespace robocell
