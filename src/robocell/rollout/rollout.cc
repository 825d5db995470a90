#include "robocell/rollout/rollout.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <nlohmann/json.hpp>

#include "robocell/base/call_hook.h"
#include "robocell/base/log.h"
#include "robocell/env/stepper.h"
#include "robocell/mujoco/warnings.h"
#include "robocell/rollout/episode_cameras.h"
#include "robocell/rollout/episode_columns.h"
#include "robocell/rollout/recorded_scene.h"
#include "robocell/rollout/stage_clock.h"
#include "robocell/spec/yaml.h"
#include "robocell/task/task_features.h"
#include "robocell/task/task_judge.h"

namespace robocell::internal {
namespace {

// Records one rollout.
class Recording {
 public:
  Recording(const RunConfig& run, const EpisodeStart& start, const std::vector<Robot>& robots,
            const std::vector<std::string>& phases, const std::vector<std::string>& subtasks,
            const PortableScene& portable, const RolloutOptions& options, RolloutTimes& times)
      : times_(times),
        simulation_(start.scene),
        generation_(start.scene.generation()),
        features_(FeaturesOfCell(start.scene, robots, start.task, run.features.names)),
        observed_(schema_, features_.observed()),
        commanded_(schema_, features_.commanded()),
        outcome_(schema_, start.scene, phases, subtasks),
        cameras_(schema_, start.scene, run.cameras, options.renderer, run.rates.policy_rate()) {
    const std::vector<double> state = start.scene.state();
    schema_.AddConstant(
        {.name = "initial_state",
         .shape = {static_cast<int64_t>(state.size())},
         .description = "The engine's full state before the first action (mjSTATE_INTEGRATION)."},
        state);
    writer_.emplace(
        options.dataset, options.episode_id, schema_,
        EpisodeOptions{.metadata_json = options.metadata_json,
                       .versions_json = nlohmann::json{{"mujoco", mj_versionString()}}.dump(),
                       .features = AllFeatures()});
    for (const auto& [name, files] : portable.models) writer_->AddModel(name, files);
  }

  // `phase`: returns the expert's, once it is valid.
  void PutState(const std::function<int()>& phase) {
    if (simulation_.generation() != generation_) {
      throw Error("scene '" + simulation_.name() +
                  "': objects were added or removed while an episode is recorded, whose rows have "
                  "numbers for those it began with; declare what may come in the scene");
    }
    {
      const StageClock::Stage stage(clock_, times_.writing);
      observed_.Put(*writer_, features_.ReadState());
      outcome_.PutPhase(*writer_, phase());
    }
    const StageClock::Stage stage(clock_, times_.rendering);
    cameras_.PutFrames(*writer_);
  }
  void RequirePhase(int phase) const { outcome_.RequirePhase(phase); }
  // Returns what PutState recorded.
  CellRow row() const { return {features_.observed(), features_.state(), cameras_.images()}; }
  void PutControl(const mjModel* model, const mjData* data) {
    const StageClock::Stage stage(clock_, times_.writing);
    outcome_.PutControl(*writer_, data->time, {data->ctrl, static_cast<size_t>(model->nu)});
  }
  void PutOutcome(const RowOutcome& outcome) {
    const StageClock::Stage stage(clock_, times_.writing);
    commanded_.Put(*writer_, features_.ReadActions());
    outcome_.PutOutcome(*writer_, outcome);
    writer_->EndRow();
  }
  void Commit(const EpisodeSummary& summary) {
    const StageClock::Stage stage(clock_, times_.writing);
    writer_->Commit(summary);
  }
  // Returns the clock for other stages, which stop while this one records.
  StageClock& clock() { return clock_; }
  EngineWarnings warnings() const { return outcome_.warnings(); }

 private:
  FeatureSchema AllFeatures() const {
    FeatureSchema all = features_.schema();
    for (const Feature& label : outcome_.labels().features()) all.Add(label);
    return all;
  }

  RolloutTimes& times_;
  Scene simulation_;
  uint64_t generation_;
  StageClock clock_;
  EpisodeSchema schema_;
  CellFeatures features_;
  FeatureColumns observed_, commanded_;
  OutcomeColumns outcome_;
  EpisodeCameras cameras_;
  std::optional<EpisodeWriter> writer_;
};

// Calls an expert's hooks. After an error that fails the rollout no hook is called any more.
class ExpertCalls {
 public:
  ExpertCalls(Expert& expert, bool errors_fail) : expert_(expert), errors_fail_(errors_fail) {}

  // Returns `otherwise` after an error.
  template <class Result, class Call>
  Result operator()(const char* method, Result otherwise, Call&& call) {
    if (!error_.empty()) return otherwise;
    try {
      return internal::CallHook(expert_, method, call);
    } catch (const HookError& error) {
      if (!errors_fail_) throw;
      error_ = PolicyError(error);
      LogWarn(error_);
      return otherwise;
    }
  }
  void Do(const char* method, const std::function<void()>& call) {
    (*this)(method, false, [&] { return call(), true; });
  }
  // Returns the error, else why the expert gave up.
  std::string failure() {
    const std::string given = (*this)("failure", std::string(), [&] { return expert_.failure(); });
    return error_.empty() ? given : error_;
  }
  bool failed() const { return !error_.empty(); }

 private:
  Expert& expert_;
  bool errors_fail_;
  std::string error_;
};

std::string Metadata(const RunConfig& run, const EpisodeStart& start, const PortableScene& portable,
                     const RolloutOptions& options) {
  nlohmann::json meta = nlohmann::json::parse(options.metadata_json);
  meta["instruction"] =
      internal::CallHook(*start.task, "instruction", [&] { return start.task->instruction(); });
  meta["target_object"] = start.target_object;
  meta["object_kinds"] = start.object_kinds;
  meta["scene_spec"] = ToYaml(portable.spec);
  meta["engine"] = EngineRecord(start.scene);
  meta["timestep"] = start.scene.timestep();
  const Ratio rows = run.rates.policy_rate();
  const Ratio step_ms = run.rates.timestep() * 1000;
  const Ratio tick_ms = step_ms * run.rates.sim_steps();
  meta["rates"] = {{"policy_ms", (tick_ms * run.rates.control_ticks()).value()},
                   {"control_ms", tick_ms.value()},
                   {"sim_ms", step_ms.value()},
                   {"policy_hz", {rows.num, rows.den}}};
  if (options.renderer) meta["renderer"] = options.renderer->description();
  return meta.dump();
}

// Returns why a rollout ended without success. Commands that could not be followed explain more
// than the timeout that they cause.
std::string WhyFailed(const RolloutResult& result, const Task& task, const std::string& gave_up,
                      bool truncated) {
  if (!gave_up.empty() && !truncated) return gave_up;
  if (!result.ik_failures.empty()) return "no IK solution for " + result.ik_failures.begin()->first;
  if (truncated) return "timeout";
  return internal::CallHook(task, "why_not_done", [&] { return task.why_not_done(); });
}

// Logs it too: a failure that is not kept leaves no record.
void NoteDivergence(const StepResult& step, const std::string& episode, RolloutResult& result) {
  result.failure = "diverged";
  result.divergence = step.message;
  LogWarn(fmt::format("episode '{}' {}", episode, step.message));
}

std::vector<std::string> Warnings(const EngineWarnings& engine, const RolloutResult& result) {
  std::vector<std::string> warnings;
  if (!result.divergence.empty()) warnings.push_back(result.divergence);
  if (engine.total()) warnings.push_back(engine.Text());
  for (const auto& [group, actions] : result.ik_failures)
    warnings.push_back(fmt::format("{} x no IK solution for {}", actions, group));
  return warnings;
}

}  // namespace

std::string PolicyError(const HookError& error) {
  return std::string("policy error: ") + error.what();
}

RolloutResult RunRollout(const RunConfig& run, EpisodeStart& start, Expert& expert, Rng& rng,
                         const RolloutOptions& given) {
  const SceneUse::Claim claim(start.scene.use(), "RunRollout");
  RolloutOptions options = given;
  const PortableScene portable = MakePortable(start.scene.spec());
  options.metadata_json = Metadata(run, start, portable, given);
  Stepper stepper(start.scene, RobotsOf(start.scene),
                  {run.rates.control_ticks(), run.rates.sim_steps()});
  TaskJudge judge(*start.task, start.scene);
  judge.Begin();
  ExpertCalls calls(expert, options.expert_errors_fail);
  calls.Do("begin", [&] { expert.Begin(start.scene, rng); });
  RolloutResult result;
  const std::vector<std::string> phases =
      calls("phase_names", std::vector<std::string>(), [&] { return expert.phase_names(); });
  Recording recording(run, start, stepper.robots(), phases, judge.subtasks(), portable, options,
                      result.times);
  stepper.set_on_control_tick(
      [&](const mjModel* m, const mjData* d) { recording.PutControl(m, d); });
  int phase = 0;
  bool terminated = false, truncated = false;
  while (!terminated && !truncated) {
    if (ShouldStop(options.stop)) return result.stopped = true, result;
    recording.PutState([&] {
      return phase = calls("phase", phase, [&] {
               const int phase_now = expert.phase();
               recording.RequirePhase(phase_now);
               return phase_now;
             });
    });
    const StageClock::Stage stage(recording.clock(), result.times.acting);
    calls.Do("see", [&] { expert.See(recording.row()); });
    StepOutcome outcome =
        calls("act", StepOutcome(), [&] { return stepper.Apply(expert.Act(start.scene, rng)); });
    if (calls.failed()) outcome = stepper.Apply({});  // all keep their targets
    stepper.Simulate(outcome);
    ++result.rows;
    const TaskVerdict verdict = outcome.ok() ? judge.Judge() : TaskVerdict();
    terminated = calls("done", true, [&] { return expert.done(); }) || !outcome.ok() ||
                 (verdict.success && expert.ends_at_success());
    // An expert's failure is not a demonstration, whatever the task's verdict.
    const bool gave_up = terminated && !calls.failure().empty();
    result.success = verdict.success && !gave_up;
    truncated = !terminated && result.rows >= run.rates.max_steps;
    if (!outcome.ok()) NoteDivergence(outcome.step, options.episode_id, result);
    const bool ik_failed = !outcome.failed_robot.empty();
    if (ik_failed) ++result.ik_failures[outcome.failed_robot + "/" + outcome.failed_group];
    recording.PutOutcome({.reward = verdict.reward,
                          .progress = verdict.progress,
                          .subtask = verdict.subtask,
                          .success = result.success,
                          .terminated = terminated,
                          .truncated = truncated,
                          .ik_failed = ik_failed,
                          .warnings = recording.warnings().total()});
  }
  if (!result.success && result.failure.empty())
    result.failure = WhyFailed(result, *start.task, calls.failure(), truncated);
  if (!result.success && !options.keep_failures) return result;
  if (options.before_commit) options.before_commit();
  recording.Commit({.success = result.success,
                    .terminated = terminated,
                    .truncated = truncated,
                    .end_reason = result.success ? "success" : result.failure,
                    .warnings = Warnings(recording.warnings(), result)});
  result.committed = true;
  return result;
}

}  // namespace robocell::internal
