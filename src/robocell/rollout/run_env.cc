#include "robocell/rollout/run_env.h"

#include <fmt/format.h>

#include <optional>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/env/stepper.h"
#include "robocell/render/renderer.h"
#include "robocell/rollout/plan.h"
#include "robocell/rollout/run_renderer.h"
#include "robocell/rollout/validate_run.h"
#include "robocell/scenes/scene_source.h"
#include "robocell/task/sampler_kind.h"
#include "robocell/task/task_features.h"
#include "robocell/task/task_judge.h"

namespace robocell {
namespace {

std::string MostOften(const RefusalCounts& reasons) {
  std::string text;
  for (const auto& [reason, count] : reasons)
    text += fmt::format("{}{} {} times", text.empty() ? "" : ", ", reason, count);
  return text;
}

// A pointer without ownership: the episode's own is the only one (RunEnv::task).
std::shared_ptr<const Task> Lent(const std::shared_ptr<Task>& task) {
  return {std::shared_ptr<void>(), task.get()};
}

// The scene of an episode and everything bound to it.
struct Running {
  Running(const RunConfig& run, EpisodeStart from, internal::TaskJudge of_task, Renderer* renderer)
      : start(std::move(from)),
        judge(std::move(of_task)),
        stepper(start.scene, RobotsOf(start.scene),
                {run.rates.control_ticks(), run.rates.sim_steps()}),
        features(
            FeaturesOfCell(start.scene, stepper.robots(), Lent(start.task), run.features.names)),
        images(start.scene, run.cameras, renderer) {}

  EpisodeStart start;
  internal::TaskJudge judge;
  Stepper stepper;
  CellFeatures features;
  CellImages images;
  bool seen = false;  // the row of the present state was read
  bool over = false;
  int rows = 0;
};

}  // namespace

struct RunEnv::State {
  RunConfig run;
  std::shared_ptr<TaskSampler> sampler;
  std::unique_ptr<Renderer> renderer;
  std::optional<Running> running;

  Running& Episode(const char* what) {
    if (running) return *running;
    throw Error(fmt::format("run '{}': {} needs an episode; call Reset first", run.run, what));
  }
};

RunEnv::RunEnv(RunConfig run) : state_(std::make_unique<State>()) {
  ValidateRunFields(run);
  state_->run = std::move(run);
  state_->sampler = MakeSampler(state_->run);
  if (!state_->run.cameras.streams.empty())
    state_->renderer = internal::MakeRendererOf(state_->run);
}
RunEnv::~RunEnv() = default;
RunEnv::RunEnv(RunEnv&&) noexcept = default;

const RunConfig& RunEnv::run() const { return state_->run; }

void RunEnv::Reset(int index, int first_attempt, const StopRequest& stop) {
  if (index < 0)
    throw ArgumentError(fmt::format("the start of an episode is a number from 0, got {}", index));
  const RunConfig& run = state_->run;
  if (!state_->sampler) throw Error(fmt::format("run '{}': its environment is gone", run.run));
  if (first_attempt < 0 || first_attempt >= run.max_attempts) {
    throw ArgumentError(fmt::format("run '{}': attempts are numbers from 0 to {}, got {}", run.run,
                                    run.max_attempts - 1, first_attempt));
  }
  const std::vector<int> scenes = SceneIndices(run);
  const auto count = static_cast<int>(scenes.size());
  const PlanItem item{
      .index = index, .scene = scenes[index % count], .episode = index / count, .id = {}};
  RefusalCounts reasons;
  for (int attempt = first_attempt; attempt < run.max_attempts && !ShouldStop(stop); ++attempt) {
    Rng rng = AttemptStream(run, item, attempt, "start");
    SampleResult sample = state_->sampler->Sample({item.scene, item.episode, attempt, stop}, rng);
    if (!sample.start) {
      ++reasons[sample.refusal.counted_as()];
      continue;
    }
    BindStart(*sample.start, run);
    internal::TaskJudge judge(*sample.start->task, sample.start->scene, "run '" + run.run + "'");
    judge.Begin();
    state_->running.reset();
    state_->running.emplace(run, std::move(*sample.start), std::move(judge),
                            state_->renderer.get());
    return;
  }
  throw Error(fmt::format("run '{}': none of {} attempts at start {} was accepted: {}", run.run,
                          run.max_attempts - first_attempt, index, MostOften(reasons)));
}

CellRow RunEnv::Row() {
  Running& episode = state_->Episode("a row");
  if (!std::exchange(episode.seen, true)) {
    episode.features.ReadState();
    episode.images.Draw();
  }
  return {episode.features.observed(), episode.features.state(), episode.images};
}

RunStep RunEnv::Act(const std::map<std::string, std::vector<double>>& actions) {
  Running& episode = state_->Episode("an action");
  if (episode.over) {
    throw Error(
        fmt::format("run '{}': the episode is over; call Reset for the next one", state_->run.run));
  }
  const Action action = episode.features.ToAction(actions);
  const StepOutcome outcome = episode.stepper.Advance(action);
  episode.seen = false;
  ++episode.rows;
  episode.over = true;  // also if the task's verdict is an error
  const TaskVerdict verdict = outcome.ok() ? episode.judge.Judge() : TaskVerdict();
  RunStep step{.reward = verdict.reward,
               .progress = verdict.progress,
               .subtask = verdict.subtask,
               .success = verdict.success,
               .terminated = verdict.success || !outcome.ok(),
               .ik_failed = !outcome.failed_robot.empty(),
               .reason = {}};
  step.truncated = !step.terminated && episode.rows >= state_->run.rates.max_steps;
  if (!outcome.ok())
    step.reason = outcome.step.message;
  else if (step.success)
    step.reason = "success";
  else if (step.truncated)
    step.reason = "timeout";
  episode.over = step.terminated || step.truncated;
  return step;
}

const FeatureSchema& RunEnv::observed() const {
  return state_->Episode("the schema").features.observed();
}
const FeatureSchema& RunEnv::commanded() const {
  return state_->Episode("the schema").features.commanded();
}
const EpisodeStart& RunEnv::start() const { return state_->Episode("the start").start; }

const std::shared_ptr<Task>& RunEnv::task() const {
  static const std::shared_ptr<Task> none;
  return state_->running ? state_->running->start.task : none;
}
const std::shared_ptr<TaskSampler>& RunEnv::sampler() const { return state_->sampler; }

void RunEnv::Drop() {
  state_->running.reset();
  state_->sampler.reset();
}

}  // namespace robocell
