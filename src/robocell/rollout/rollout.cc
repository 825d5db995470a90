#include "robocell/rollout/rollout.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <optional>
#include <string>
#include <vector>
#include <nlohmann/json.hpp>

#include "robocell/base/error.h"
#include "robocell/base/log.h"
#include "robocell/rollout/action_noise.h"
#include "robocell/rollout/exact_replay.h"
#include "robocell/rollout/expert_calls.h"
#include "robocell/rollout/rollout_recording.h"
#include "robocell/rollout/run_cell.h"
#include "robocell/task/task_calls.h"

namespace robocell::internal {
namespace {

enum class FailureKind { kGaveUp, kNoIkSolution, kTimeout, kNotDone };

// Why a rollout ended without success.
struct Failure {
  FailureKind kind;
  std::string text;
};

// Commands that could not be followed explain more than the timeout that they cause.
Failure FailureOf(const RolloutResult& result, Task& task, const std::string& gave_up,
                  const RowLabels& labels) {
  if (!gave_up.empty() && !labels.truncated) return {FailureKind::kGaveUp, gave_up};
  if (!result.ik_failures.empty()) {
    return {FailureKind::kNoIkSolution, "no IK solution for " + result.ik_failures.begin()->first};
  }
  if (labels.truncated) return {FailureKind::kTimeout, "timeout"};
  return {FailureKind::kNotDone, TaskCalls(task).WhyNotDone()};
}

void NoteFailure(const Failure& failure, const std::string& episode, RolloutResult& result) {
  result.failure = failure.text;
  if (failure.kind != FailureKind::kNoIkSolution) return;
  LogDebug(fmt::format("episode '{}': {}, first at {}", episode, failure.text,
                       result.ik_failures.begin()->second.first));
}

// Logs it too: a failure that is not kept leaves no record.
void NoteDivergence(const StepResult& step, const std::string& episode, RolloutResult& result) {
  result.failure = "diverged";
  result.divergence = step.message;
  LogWarn(fmt::format("episode '{}' {}", episode, step.message));
}

std::vector<std::string> Warnings(const EngineWarnings& engine, const RolloutResult& result,
                                  const ActionNoise* noise) {
  std::vector<std::string> warnings;
  if (!result.divergence.empty()) warnings.push_back(result.divergence);
  if (engine.total()) warnings.push_back(engine.Text());
  for (const auto& [group, none] : result.ik_failures) {
    warnings.push_back(
        fmt::format("{} x no IK solution for {}, first at {}", none.actions, group, none.first));
  }
  if (noise && 2 * noise->without_noise() > noise->actions()) {
    warnings.push_back(
        fmt::format("{} of {} actions are without noise: no posture near them has the displaced "
                    "pose, or no arm has joint position targets",
                    noise->without_noise(), noise->actions()));
  }
  return warnings;
}

// Returns the results that an expert records. Throws ArgumentError for what is no JSON object.
nlohmann::json ResultsOfExpert(const Expert& expert) {
  const std::string text = expert.results_json();
  nlohmann::json results = nlohmann::json::parse(text, nullptr, false);
  if (results.is_object()) return results;
  throw ArgumentError(
      fmt::format("the expert's results_json() must return a JSON object as text, such as "
                  "{{\"grasps\": 2}}, got '{}'",
                  text));
}

// Returns the expert's results, what the noise did, and for evaluations whether an error of the
// policy ended the rollout.
std::string ResultsOf(ExpertCalls& calls, const Expert& expert, const RolloutResult& result,
                      const ActionNoise* noise, const RolloutOptions& options) {
  nlohmann::json results =
      calls("results_json", nlohmann::json::object(), [&] { return ResultsOfExpert(expert); });
  if (noise) {
    results["noise"] = {{"actions", noise->actions()},
                        {"actions_without_noise", noise->without_noise()}};
    if (options.start_displaced) results["noise"]["start_displaced"] = *options.start_displaced;
  }
  if (calls.failed() && !result.success) results["policy_error"] = true;
  return results.dump();
}

void NoteNoIkSolution(const StepOutcome& step, double time, const std::string& phase,
                      RolloutResult& result) {
  NoIkSolution& none = result.ik_failures[step.failed_robot + "/" + step.failed_group];
  if (none.actions++ > 0) return;
  none.first = fmt::format("{:.2f} s{}, {:.3f} m and {:.2f} rad from the pose", time,
                           phase.empty() ? "" : ", in phase '" + phase + "'",
                           step.ik.position_error, step.ik.rotation_error);
}

// Wakes all bodies: a recorded state does not say which ones sleep, and its replay begins with all
// of them awake.
void WakeAll(Scene& scene) {
  if (scene.model()->opt.enableflags & mjENBL_SLEEP) scene.SetState(scene.state());
}

// Returns the result of a rollout that ends before it is done.
RolloutResult Stopped(RolloutResult result) {
  result.stopped = true;
  return result;
}

}  // namespace

RolloutResult RunRollout(const RunConfig& run, EpisodeStart& start, Expert& expert, Rng& rng,
                         const RolloutOptions& options) {
  const SceneUse::Claim claim(start.scene.use(), "RunRollout");
  const PortableScene portable =
      options.stores ? MakePortable(start.scene.spec()) : PortableScene();
  WakeAll(start.scene);
  RunCell in(run, start, options.renderer);
  ExpertCalls calls(expert, options.expert_errors_fail);
  calls.Do("begin", [&] { expert.Begin(start.scene, rng); });
  RolloutResult result;
  const std::vector<std::string> phases =
      calls("phase_names", std::vector<std::string>(), [&] { return expert.phase_names(); });
  std::optional<ActionNoise> noise;
  if (run.noise)
    noise.emplace(in.cell.robots(), *run.noise, run.rates.policy_period(), options.noise.value());
  std::optional<ExactReplay> replay;
  if (options.judge_replay) {
    replay.emplace(start.scene, *start.task,
                   StepperRates{run.rates.control_ticks(), run.rates.sim_steps()});
  }
  RolloutRecording recording(
      run, start, in, phases, portable, options, result.times,
      {.noise = noise ? &*noise : nullptr, .replay = replay ? &*replay : nullptr});
  int phase = 0;
  const auto act = [&] { return expert.Act(start.scene, rng); };
  std::optional<Action> acted;  // before the step, if actions take effect later
  // An expert sees the targets that it set: its relative commands do not add up noise.
  const auto act_before_step = [&] {
    if (noise) in.cell.Send(noise->Intended());
    acted = calls("act", Action(), act);
    if (noise) in.cell.Send(noise->noisy());
  };
  // All groups keep their targets when the expert has raised an error.
  const auto send = [&] {
    if (noise) in.cell.Send(noise->Intended());
    StepOutcome sent =
        calls("act", StepOutcome(), [&] { return in.cell.Send(acted ? *acted : act()); });
    if (calls.failed()) sent = in.cell.Send({});
    if (noise) in.cell.Send(noise->Perturb());
    return sent;
  };
  constexpr bool kOnceFailed = true;  // an expert that raised an error is done
  RowLabels labels;
  while (!labels.terminated && !labels.truncated) {
    if (ShouldStop(options.stop)) return Stopped(result);
    recording.PutState([&] {
      return phase = calls("phase", phase, [&] {
               const int phase_now = expert.phase();
               recording.RequirePhase(phase_now);
               return phase_now;
             });
    });
    const StageClock::Stage stage(recording.clock(), result.times.acting);
    if (!recording.LetLook([&] { calls.Do("see", [&] { expert.See(in.Row()); }); }))
      return Stopped(result);
    const double time = start.scene.time();
    CellStep step;
    const bool has_looked = recording.LetLook([&] {
      if (in.cell.action_delay() > 0) act_before_step();
      step = in.cell.Step({.send = send});
    });
    if (!has_looked) return Stopped(result);
    if (step.step.status == StepResult::kStopped) return Stopped(result);
    TaskVerdict& verdict = step.verdict;
    ++result.rows;
    labels.terminated = calls("done", kOnceFailed, [&] { return expert.done(); }) || !step.ok() ||
                        (verdict.success && calls("ends_at_success", kOnceFailed,
                                                  [&] { return expert.ends_at_success(); }));
    // An expert's failure is not a demonstration, whatever the task's verdict.
    const bool gave_up = labels.terminated && !calls.failure().empty();
    result.success = verdict.success = verdict.success && !gave_up;
    labels.truncated = !labels.terminated && result.rows >= run.rates.max_steps;
    if (!step.ok()) NoteDivergence(step.step, options.episode_id, result);
    labels.ik_failed = !step.failed_robot.empty();
    if (labels.ik_failed) {
      const auto index = static_cast<size_t>(phase);
      NoteNoIkSolution(step, time, index < phases.size() ? phases[index] : "", result);
    }
    labels.warnings = recording.warnings().total();
    const bool is_put = recording.PutOutcome({verdict, labels});
    if (!is_put) return Stopped(result);
  }
  const EngineWarnings warnings = recording.warnings();  // without those of the replay
  if (result.success && replay) {
    const StageClock::Stage stage(recording.clock(), result.times.acting);
    result.failure = replay->Judge();
    result.success = result.failure.empty();
  }
  if (!result.success && result.failure.empty())
    NoteFailure(FailureOf(result, *start.task, calls.failure(), labels), options.episode_id,
                result);
  if (!result.success && !options.keep_failures) {
    recording.RequireWritten();
    return result;
  }
  if (!options.stores) return result;
  if (!recording.Finish()) return Stopped(result);
  if (options.before_commit) options.before_commit();
  result.committed = recording.Commit(
      {.success = result.success,
       .terminated = labels.terminated,
       .truncated = labels.truncated,
       .end_reason = result.success ? "success" : result.failure,
       .warnings = Warnings(warnings, result, noise ? &*noise : nullptr),
       .results_json = ResultsOf(calls, expert, result, noise ? &*noise : nullptr, options)});
  result.stopped = !result.committed;
  return result;
}

}  // namespace robocell::internal
