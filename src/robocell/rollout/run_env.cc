#include "robocell/rollout/run_env.h"

#include <fmt/format.h>

#include <optional>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/render/renderer.h"
#include "robocell/rollout/plan.h"
#include "robocell/rollout/run_cell.h"
#include "robocell/rollout/run_renderer.h"
#include "robocell/rollout/start_draw.h"
#include "robocell/rollout/validate_run.h"
#include "robocell/scenes/scene_source.h"
#include "robocell/task/sampler_kind.h"
#include "robocell/task/task_calls.h"

namespace robocell {
namespace {

// An episode: its start, and the cell in it.
struct Running {
  Running(const RunConfig& run, EpisodeStart from, Renderer* renderer)
      : start(std::move(from)), in(run, start, renderer, "run '" + run.run + "'") {}

  EpisodeStart start;  // with the only reference to its task (RunEnv::task)
  internal::RunCell in;
  bool seen = false;  // the row of the present state was read
  bool over = false;
  int rows = 0;
};

}  // namespace

struct RunEnv::State {
  RunConfig run;
  DataFactory scene_data;
  std::shared_ptr<TaskSampler> sampler;
  std::unique_ptr<Renderer> renderer;
  std::optional<Running> running;

  Running& Episode(const char* what) {
    if (running) return *running;
    throw Error(fmt::format("run '{}': {} needs an episode; call reset first", run.run, what));
  }
};

RunEnv::RunEnv(RunConfig run, DataFactory scene_data) : state_(std::make_unique<State>()) {
  ValidateRunFields(run, {.output = false});
  state_->run = std::move(run);
  state_->scene_data = std::move(scene_data);
  state_->sampler = MakeSampler(state_->run);
  if (!state_->run.cameras.drawn().empty())
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
  const internal::StartDraw from{run, *state_->sampler, state_->scene_data, !run.sampler.empty()};
  internal::RefusedStarts refused;
  for (int attempt = first_attempt; attempt < run.max_attempts && !ShouldStop(stop); ++attempt) {
    SampleResult drawn = internal::DrawStart(from, item, attempt, stop);
    if (!drawn.start) {
      if (ShouldStop(stop)) break;  // its reason is arbitrary then
      refused.Add(drawn.refusal);
      continue;
    }
    BindStart(*drawn.start, run);
    state_->running.reset();
    state_->running.emplace(run, std::move(*drawn.start), state_->renderer.get());
    return;
  }
  if (refused.total() == run.max_attempts - first_attempt) {
    throw Error(fmt::format("run '{}': none of {} at start {} was accepted{}", run.run,
                            Counted(refused.total(), "attempt"), index, refused.Text()));
  }
  throw Error(fmt::format("run '{}': stopped after {} at start {}, before one was accepted{}",
                          run.run, Counted(refused.total(), "attempt"), index, refused.Text()));
}

CellRow RunEnv::Row() {
  Running& episode = state_->Episode("a row");
  if (!std::exchange(episode.seen, true)) {
    episode.in.features.ReadState();
    episode.in.images.Draw();
  }
  return episode.in.Row();
}

RunStep RunEnv::Act(const std::map<std::string, std::vector<double>>& actions) {
  Running& episode = state_->Episode("an action");
  if (episode.over) {
    throw Error(
        fmt::format("run '{}': the episode is over; call reset for the next one", state_->run.run));
  }
  const Action action = episode.in.features.ToAction(actions);
  const auto send = [&] {
    const StepOutcome sent = episode.in.cell.Send(action);
    episode.seen = false;
    episode.over = true;  // until the step is complete: the task's verdict may be an error
    return sent;
  };
  const internal::CellStep made = episode.in.cell.Step({.send = send});
  ++episode.rows;
  RunStep step{made.verdict};
  const bool stopped = made.step.status == StepResult::kStopped;  // by the user of a viewer
  step.terminated = step.success || (!made.ok() && !stopped);
  step.ik_failed = !made.failed_robot.empty();
  step.truncated = !step.terminated && (stopped || episode.rows >= state_->run.rates.max_steps);
  if (!made.ok())
    step.reason = made.step.message;
  else if (step.success)
    step.reason = "success";
  else if (step.truncated)
    step.reason = "timeout";
  episode.over = step.terminated || step.truncated;
  return step;
}

const FeatureSchema& RunEnv::observed() const {
  return state_->Episode("the schema").in.features.observed();
}
const FeatureSchema& RunEnv::commanded() const {
  return state_->Episode("the schema").in.features.commanded();
}
const EpisodeStart& RunEnv::start() const { return state_->Episode("the start").start; }

std::string RunEnv::instruction() const { return internal::TaskCalls(*start().task).Instruction(); }

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
