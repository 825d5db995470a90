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
            const Expert& expert, const std::vector<std::string>& subtasks,
            const PortableScene& portable, const RolloutOptions& options, RolloutTimes& times)
      : times_(times),
        simulation_(start.scene),
        generation_(start.scene.generation()),
        features_(FeaturesOfCell(start.scene, robots, start.task, run.features.names)),
        observed_(schema_, features_.observed()),
        commanded_(schema_, features_.commanded()),
        outcome_(schema_, start.scene,
                 internal::CallHook(expert, "phase_names", [&] { return expert.phase_names(); }),
                 subtasks),
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

  void PutState(const Expert& expert) {
    if (simulation_.generation() != generation_) {
      throw Error("scene '" + simulation_.name() +
                  "': objects were added or removed while an episode is recorded, whose rows have "
                  "numbers for those it began with; declare what may come in the scene");
    }
    {
      const StageClock::Stage stage(clock_, times_.writing);
      observed_.Put(*writer_, features_.ReadState());
      const int phase = internal::CallHook(expert, "phase", [&] {
        const int told = expert.phase();
        outcome_.RequirePhase(told);
        return told;
      });
      outcome_.PutPhase(*writer_, phase);
    }
    const StageClock::Stage stage(clock_, times_.rendering);
    cameras_.PutFrames(*writer_);
  }
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
std::string WhyFailed(const RolloutResult& result, const Task& task, const Expert& expert,
                      bool truncated) {
  if (!expert.failure().empty() && !truncated) return expert.failure();
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
  internal::CallHook(expert, "begin", [&] { expert.Begin(start.scene, rng); });
  RolloutResult result;
  Recording recording(run, start, stepper.robots(), expert, judge.subtasks(), portable, options,
                      result.times);
  stepper.set_on_control_tick(
      [&](const mjModel* m, const mjData* d) { recording.PutControl(m, d); });
  bool terminated = false, truncated = false;
  while (!terminated && !truncated) {
    if (ShouldStop(options.stop)) return result.stopped = true, result;
    recording.PutState(expert);
    const StageClock::Stage stage(recording.clock(), result.times.acting);
    internal::CallHook(expert, "see", [&] { expert.See(recording.row()); });
    StepOutcome outcome = internal::CallHook(
        expert, "act", [&] { return stepper.Apply(expert.Act(start.scene, rng)); });
    stepper.Simulate(outcome);
    ++result.rows;
    const TaskVerdict verdict = outcome.ok() ? judge.Judge() : TaskVerdict();
    terminated = internal::CallHook(expert, "done", [&] { return expert.done(); }) ||
                 !outcome.ok() || (verdict.success && expert.ends_at_success());
    // An expert's failure is not a demonstration, whatever the task's verdict.
    const bool gave_up = terminated && !internal::CallHook(expert, "failure", [&] {
                                          return expert.failure();
                                        }).empty();
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
    result.failure = WhyFailed(result, *start.task, expert, truncated);
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
