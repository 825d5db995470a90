#include "robocell/datagen/runner.h"

#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "robocell/base/error.h"
#include "robocell/data/episode_reader.h"
#include "robocell/datagen/rollout.h"
#include "robocell/spec/validate.h"
#include "robocell/task/pick_planner.h"
#include "robocell/task/pick_sampler.h"

namespace robocell {
namespace {

// What a spec may say but this version cannot record: refused, not ignored.
void CheckRecordable(const RunConfig& run) {
  Problems problems;
  for (size_t i = 0; i < run.cameras.streams.size(); ++i) {
    Problems::Scope cameras(problems, "cameras.streams");
    Problems::Scope item(problems, i);
    const CameraConfig& stream = run.cameras.streams[i];
    if (stream.rate != 0)
      problems.AddAt("rate", "records take one frame per action; leave rate at 0");
    if (stream.depth) problems.AddAt("depth", "depth cannot be recorded yet, only rgb; remove it");
    if (stream.segmentation)
      problems.AddAt("segmentation", "segmentation cannot be recorded yet, only rgb; remove it");
    if (!stream.rgb) problems.AddAt("rgb", "a recorded stream needs rgb: true");
  }
  problems.Throw("run '" + run.run + "'");
}

double Seconds(std::chrono::steady_clock::time_point since) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - since).count();
}

}  // namespace

struct Runner::State {
  RunConfig run;
  RunnerParts parts;
  std::unique_ptr<TaskSampler> sampler;
  std::unique_ptr<Renderer> renderer;

  Renderer* EnsureRenderer() {
    if (!renderer && !run.cameras.streams.empty())
      renderer = MakeRenderer({.quality = run.cameras.quality});
    return renderer.get();
  }
  RolloutOptions Options(const PlanItem& item, int attempt, const std::atomic<bool>* stop);
  void Attempt(const PlanItem& item, int attempt, const std::atomic<bool>* stop,
               EpisodeReport& report);
};

namespace {

// Where an attempt is kept. With failures kept, several attempts of an item stand side by side.
std::string EpisodeId(const RunConfig& run, const PlanItem& item, int attempt) {
  return run.keep == Keep::kAll ? fmt::format("{}_a{:02}", item.id, attempt) : item.id;
}

}  // namespace

RolloutOptions Runner::State::Options(const PlanItem& item, int attempt,
                                      const std::atomic<bool>* stop) {
  const nlohmann::json metadata = {{"run", run.run},
                                   {"seed", run.seed},
                                   {"scene", item.scene},
                                   {"episode", item.episode},
                                   {"attempt", attempt},
                                   {"task", ToString(run.task.kind)},
                                   {"identity", RunIdentity(run)}};
  return {.dataset = run.output,
          .episode_id = EpisodeId(run, item, attempt),
          .metadata_json = metadata.dump(),
          .keep_failures = run.keep == Keep::kAll,
          .renderer = EnsureRenderer(),
          .stop = stop};
}

Runner::Runner(RunConfig run, RunnerParts parts) : state_(std::make_unique<State>()) {
  RequireValid(run, "run '" + run.run + "'");
  CheckRecordable(run);
  state_->run = std::move(run);
  state_->parts = std::move(parts);
  if (!state_->parts.sampler) state_->parts.sampler = MakePickSampler;
  if (!state_->parts.expert) state_->parts.expert = MakePickPlanner;
  state_->sampler = state_->parts.sampler(state_->run);
}

Runner::~Runner() = default;

const RunConfig& Runner::run() const { return state_->run; }

namespace {

// What an earlier process left of an attempt: unset when nothing, else whether it was a success.
std::optional<bool> KeptSuccess(const RunConfig& run, const std::string& episode_id) {
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::path(run.output) / episode_id;
  if (!std::filesystem::is_directory(folder, error)) return std::nullopt;
  return Episode(folder).success();
}

// Failures are there only when they are kept, each attempt on its own.
bool HasSuccess(const RunConfig& run, const PlanItem& item) {
  if (run.keep != Keep::kAll) return KeptSuccess(run, item.id).has_value();
  for (int attempt = 0; attempt < run.max_attempts; ++attempt) {
    if (KeptSuccess(run, EpisodeId(run, item, attempt)).value_or(false)) return true;
  }
  return false;
}

// Sums up a rollout.
void AddTo(EpisodeReport& report, const RolloutResult& rollout) {
  report.stopped = rollout.stopped;
  if (rollout.stopped) return;
  if (!rollout.success) ++report.failures[rollout.failure];
  report.committed |= rollout.committed;
  report.kept += rollout.committed;
  report.success = rollout.success;
  if (rollout.committed) report.rows = rollout.rows;
  report.seconds_acting += rollout.times.acting;
  report.seconds_rendering += rollout.times.rendering;
  report.seconds_writing += rollout.times.writing;
}

}  // namespace

bool IsComplete(const RunConfig& run, const PlanItem& item) {
  if (HasSuccess(run, item)) return true;
  return run.keep == Keep::kAll &&
         KeptSuccess(run, EpisodeId(run, item, run.max_attempts - 1)).has_value();
}

void Runner::State::Attempt(const PlanItem& item, int attempt, const std::atomic<bool>* stop,
                            EpisodeReport& report) {
  ++report.attempts;
  const auto began = std::chrono::steady_clock::now();
  Rng start_rng = AttemptStream(run, item, attempt, "start");
  SampleResult sample = sampler->Sample({item.scene, item.episode, attempt}, start_rng);
  report.seconds_sampling += Seconds(began);
  if (!sample.start) {
    ++report.refusals[ToString(sample.refusal.reason)];
    return;
  }
  ++report.accepted;
  const std::unique_ptr<Expert> expert = parts.expert(run, *sample.start);
  Rng expert_rng = AttemptStream(run, item, attempt, "expert");
  AddTo(report, RunRollout(run, *sample.start, *expert, expert_rng, Options(item, attempt, stop)));
}

EpisodeReport Runner::Run(const PlanItem& item, const std::atomic<bool>* stop) {
  EpisodeReport report{.item = item, .refusals = {}, .failures = {}};
  const RunConfig& run = state_->run;
  if (IsComplete(run, item)) {
    report.committed = report.resumed = true;
    report.success = HasSuccess(run, item);
    return report;
  }
  for (int attempt = 0; attempt < run.max_attempts && !report.success; ++attempt) {
    if (stop && stop->load()) report.stopped = true;
    if (report.stopped) return report;
    if (run.keep == Keep::kAll && KeptSuccess(run, EpisodeId(run, item, attempt))) {
      report.committed = true;  // a failure of an earlier process
      continue;
    }
    state_->Attempt(item, attempt, stop, report);
  }
  return report;
}

}  // namespace robocell
