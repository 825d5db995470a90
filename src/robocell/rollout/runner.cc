#include "robocell/rollout/runner.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <exception>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "robocell/base/call_hook.h"
#include "robocell/base/error.h"
#include "robocell/base/log.h"
#include "robocell/data/dataset.h"
#include "robocell/data/dataset_lock.h"
#include "robocell/expert/demonstration.h"
#include "robocell/expert/expert_kind.h"
#include "robocell/rollout/action_noise.h"
#include "robocell/rollout/expert_calls.h"
#include "robocell/rollout/on_disk.h"
#include "robocell/rollout/rollout.h"
#include "robocell/rollout/run_inputs.h"
#include "robocell/rollout/run_origin.h"
#include "robocell/rollout/run_renderer.h"
#include "robocell/rollout/source_demos.h"
#include "robocell/rollout/start_draw.h"
#include "robocell/rollout/validate_run.h"
#include "robocell/task/sampler_kind.h"
#include "robocell/task/task_kind.h"

namespace robocell {
namespace {

double Seconds(std::chrono::steady_clock::time_point since) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - since).count();
}

// Stands for an expert that could not be made: its rollout ends at once, with the error.
class UnmadeExpert final : public Expert {
 public:
  explicit UnmadeExpert(const std::exception_ptr& error) { error_ = error; }
  void Begin(const Scene& /*scene*/, Rng& /*rng*/) override { std::rethrow_exception(error_); }
  Action Act(const Scene& /*scene*/, Rng& /*rng*/) override { return {}; }
  bool done() const override { return true; }
  std::string failure() const override { return ""; }
  int phase() const override { return 0; }
  std::vector<std::string> phase_names() const override { return {}; }

 private:
  std::exception_ptr error_;
};

// Returns true if a run calls code that is not part of robocell.
bool HasUsersCode(const RunConfig& run, const RunnerParts& parts) {
  return parts.sampler || parts.expert || !run.sampler.empty() || !run.features.names.empty() ||
         !FindTaskKind(run.task.kind())->is_built_in() ||
         (!run.augment && !ExpertKindFor(run)->is_built_in());
}

using MakeExpertFunction =
    std::function<std::shared_ptr<Expert>(const RunConfig&, const EpisodeStart&)>;

// Returns what makes the experts that a run names.
MakeExpertFunction ExpertsOf(const RunConfig& run) {
  if (run.augment) {
    // Read when the first one is made: a runner whose items exist reads nothing.
    return [sources = internal::Demonstrations()](const RunConfig& of,
                                                  const EpisodeStart& start) mutable {
      if (!sources) sources = internal::ReadSources(of);
      return internal::MakeAugmentExpert(of, start, sources);
    };
  }
  return [kind = ExpertKindFor(run)](const RunConfig& of, const EpisodeStart& start) {
    return kind->Make(of, start);
  };
}

}  // namespace

struct Runner::State {
  RunConfig run;
  std::string identity;  // of the run
  RunnerParts parts;
  bool own_sampler = false;     // true for the user's sampler: only it knows the task's object
  bool has_users_code = false;  // among task, sampler, expert and features
  std::vector<std::string> unregistered;  // parts that no name in the run stands for
  std::shared_ptr<TaskSampler> sampler;
  std::vector<std::unique_ptr<Renderer>> renderers;  // one for each thread that draws
  std::optional<std::string> checked_manifest;
  RunFilesWatch models;
  bool stale_sampler = false;  // may remember scenes of changed models

  // Makes the renderers, if the run has images.
  void EnsureRenderers() {
    if (!renderers.empty() || run.cameras.drawn().empty()) return;
    renderers.push_back(internal::MakeRendererOf(run));
    const int threads = internal::DrawingThreads(run, *renderers.front());
    while (static_cast<int>(renderers.size()) < threads)
      renderers.push_back(internal::MakeRendererOf(run));
  }
  std::optional<RenderWhen> render;
  RenderWhen EnsureRender() {
    if (!render) render = internal::RenderOf(run);
    return *render;
  }
  std::optional<std::string> advice;
  // Advises from where the robot would reach; "" for a user's own task. Computed once.
  const std::string& Advice();
  DatasetLock Enter();
  void RequireSameParts() const;
  void RequireUnchangedModels();
  internal::RolloutOptions Options(const PlanItem& item, int attempt,
                                   const EarlierAttempts& earlier, const StopRequest& stop);
  // In evaluations an error of the expert is a failure from this start (kFirst).
  bool do_expert_errors_fail() const { return run.keep == Keep::kFirst; }
  std::shared_ptr<Expert> MakeExpert(const EpisodeStart& start) const;
  void Attempt(const PlanItem& item, int attempt, const StopRequest& stop, EarlierAttempts& earlier,
               ItemResult& result);
  // Likewise, but an exception of a user's own code is a failure, unless it is the last of a row
  // or no other start may take the place of an accepted one.
  void TryAttempt(const PlanItem& item, int attempt, const StopRequest& stop,
                  EarlierAttempts& earlier, ItemResult& result);
  // Returns the text of the exception being handled; "" if it is not from a user's code.
  std::string WhatUsersCodeRaised() const;
  bool has_samplers_hooks() const { return own_sampler || !run.sampler.empty(); }
  internal::RefusedStarts refused;  // of the present item
  int raised = 0;                   // errors in a row
  bool start_accepted = false;      // true once the present attempt has a start
  std::string object_kind;          // of that start
};

// Returns the lock for writing into the dataset, as long as it is the one that the run was checked
// against.
DatasetLock Runner::State::Enter() {
  if (!checked_manifest) {  // before anything is written, including a lock
    const std::optional<std::string> before = ReadManifest(run.output);
    models = RunFilesWatch(RequireSameRun(run));
    RequireSameParts();
    checked_manifest = before;
  }
  DatasetLock lock = DatasetLock::Writing(run.output);
  const std::optional<std::string> manifest = ReadManifest(run.output);
  if (!manifest || manifest != checked_manifest) models = RunFilesWatch(RequireSameRun(run));
  checked_manifest = manifest;
  RequireUnchangedModels();
  if (std::exchange(stale_sampler, false)) sampler = parts.sampler(run);
  return lock;
}

// Throws ArgumentError if episodes of the dataset were made with other unregistered parts, which
// the identity of a run does not contain.
void Runner::State::RequireSameParts() const {
  const Dataset made(run.output);
  if (made.size() == 0) return;
  const std::vector<std::string> theirs = internal::UnregisteredParts(made.At(0));
  if (theirs == unregistered) return;
  const auto words = [](const std::vector<std::string>& parts) {
    return parts.empty() ? std::string("the registered parts of its run")
                         : fmt::format("an unregistered {}", fmt::join(parts, " and "));
  };
  throw ArgumentError(fmt::format(
      "run '{}': the episodes in '{}' were made with {}, this Runner has {}; go on with the same "
      "parts, or choose another `output`",
      run.run, run.output, words(theirs), words(unregistered)));
}

void Runner::State::RequireUnchangedModels() {
  try {
    models.RequireUnchanged(run);
  } catch (const IoError&) {
    stale_sampler = true;
    throw;
  }
}

const std::string& Runner::State::Advice() {
  if (advice) return *advice;
  advice.emplace();
  if (own_sampler) return *advice;
  try {
    advice = FindTaskKind(run.task.kind())->AdviseReach(run).text;
  } catch (const Error& error) {
    LogDebug(std::string("no advice on reach: ") + error.what());
  }
  return *advice;
}

internal::RolloutOptions Runner::State::Options(const PlanItem& item, int attempt,
                                                const EarlierAttempts& earlier,
                                                const StopRequest& stop) {
  nlohmann::json metadata = {{"run", run.run},
                             {"seed", run.seed},
                             {"scene", item.scene},
                             {"episode", item.episode},
                             {"attempt", attempt},
                             {kEarlierAttempts, nlohmann::json::parse(ToJson(earlier))},
                             {"task", own_sampler ? "custom" : run.task.kind()},
                             {"identity", identity}};
  if (!unregistered.empty()) metadata[internal::kUnregisteredParts] = unregistered;
  EnsureRenderers();
  std::vector<Renderer*> more;
  for (size_t i = 1; i < renderers.size(); ++i) more.push_back(renderers[i].get());
  return {.dataset = run.output,
          .episode_id = EpisodeId(run, item, attempt),
          .metadata_json = metadata.dump(),
          .keep_failures = run.keep != Keep::kSuccesses,
          .renderer = renderers.empty() ? nullptr : renderers.front().get(),
          .more_renderers = std::move(more),
          .render = EnsureRender(),
          .stop = stop,
          .before_commit = [this] { RequireUnchangedModels(); },
          .expert_errors_fail = do_expert_errors_fail(),
          .judge_replay = run.augment.has_value(),
          .stores = parts.stores};
}

Runner::Runner(RunConfig run, RunnerParts parts) : state_(std::make_unique<State>()) {
  ValidateRunFields(run);
  state_->run = std::move(run);
  state_->identity = RunIdentity(state_->run);
  state_->parts = std::move(parts);
  state_->own_sampler = static_cast<bool>(state_->parts.sampler);
  state_->has_users_code = HasUsersCode(state_->run, state_->parts);
  if (state_->parts.sampler) state_->unregistered.emplace_back("sampler");
  if (state_->parts.expert) state_->unregistered.emplace_back("expert");
  if (!state_->own_sampler) {
    state_->parts.sampler = &MakeSampler;
  }
  if (!state_->parts.expert) {
    state_->parts.expert = ExpertsOf(state_->run);
  }
  state_->sampler = state_->parts.sampler(state_->run);
}

Runner::~Runner() = default;

const RunConfig& Runner::run() const { return state_->run; }
const std::shared_ptr<TaskSampler>& Runner::sampler() const { return state_->sampler; }
void Runner::DropSampler() { state_->sampler.reset(); }

namespace {

// Removes an undecided attempt: neither accepted nor refused, neither success nor failure.
void Drop(ItemResult& result) {
  result.stopped = true;
  ++result.undecided;
}

// Returns the kind of object that the episode's sampler named; "" if it named none.
std::string ObjectKindOf(const Episode& episode) {
  const auto kinds =
      nlohmann::json::parse(episode.metadata_json()).value("object_kinds", nlohmann::json::array());
  return kinds.empty() ? "" : kinds.front().get<std::string>();
}

// An attempt that an earlier process kept counts like a new one: the report is about the item.
void AddKept(ItemResult& result, const Episode& episode, EarlierAttempts& earlier) {
  result.object_kind = ObjectKindOf(episode);
  result.committed = true;
  result.success = episode.success();
  result.rows = static_cast<int>(episode.rows());
  ++result.attempts;
  ++result.accepted;
  if (!result.object_kind.empty()) {
    ++result.kinds[result.object_kind];
    ++result.rollouts[result.object_kind];
  }
  if (result.success) return;
  ++result.failures[episode.end_reason()];
  earlier.push_back({.object_kind = result.object_kind, .reason = episode.end_reason()});
}

// Adds a rollout to the sums.
void AddTo(ItemResult& result, const internal::RolloutResult& rollout, bool stores) {
  if (rollout.stopped) return Drop(result);
  ++result.attempts;
  ++result.accepted;
  if (!rollout.success) ++result.failures[rollout.failure];
  result.failure = rollout.failure;
  result.committed |= rollout.committed;
  result.kept += rollout.committed;
  result.success = rollout.success;
  if (rollout.committed || !stores) result.rows = rollout.rows;
  result.seconds_acting += rollout.times.acting;
  result.seconds_rendering += rollout.times.rendering;
  result.seconds_writing += rollout.times.writing;
}

}  // namespace

void Runner::State::Attempt(const PlanItem& item, int attempt, const StopRequest& stop,
                            EarlierAttempts& earlier, ItemResult& result) {
  const auto began = std::chrono::steady_clock::now();
  SampleResult sample = internal::DrawStart({run, *sampler, parts.scene_data, has_samplers_hooks()},
                                            item, attempt, stop);
  result.seconds_sampling += Seconds(began);
  if (ShouldStop(stop)) return Drop(result);
  RequireUnchangedModels();
  const auto count_redrawn = [&] {
    for (const auto& [reason, count] : sample.redrawn()) result.redrawn[reason] += count;
  };
  const auto count_kind = [&, kind = sample.object_kind()] {
    result.object_kind = kind;
    if (kind.empty()) return;
    ++result.kinds[kind];
    if (sample.start) ++result.rollouts[kind];
  };
  if (!sample.start) {
    count_redrawn();
    count_kind();
    ++result.attempts;
    earlier.push_back({.object_kind = sample.object_kind(),
                       .refused = true,
                       .reason = sample.refusal.counted_as()});
    refused.Add(sample.refusal);
    result.refusals = refused.counts();
    result.out_of_reach = refused.out_of_reach();
    result.advice = refused.detail();
    return;
  }
  start_accepted = true;
  object_kind = sample.object_kind();
  BindStart(*sample.start, run);
  Rng noise = AttemptStream(run, item, attempt, "noise");
  const std::optional<bool> displaced = internal::DisplaceStart(run, *sample.start, noise);
  const std::shared_ptr<Expert> expert = MakeExpert(*sample.start);
  Rng expert_rng = AttemptStream(run, item, attempt, "expert");
  internal::RolloutOptions options = Options(item, attempt, earlier, stop);
  options.noise = noise;
  options.start_displaced = displaced;
  const internal::RolloutResult rollout =
      internal::RunRollout(run, *sample.start, *expert, expert_rng, options);
  AddTo(result, rollout, parts.stores);
  if (result.stopped) return;
  if (!rollout.committed) RequireUnchangedModels();  // failures count too
  if (!rollout.success)
    earlier.push_back({.object_kind = sample.object_kind(), .reason = rollout.failure});
  count_redrawn();
  count_kind();
}

std::shared_ptr<Expert> Runner::State::MakeExpert(const EpisodeStart& start) const {
  try {
    return internal::CallHook(Hooks(), "the expert's constructor",
                              [&] { return parts.expert(run, start); });
  } catch (const HookError&) {
    if (!do_expert_errors_fail()) throw;
    return std::make_shared<UnmadeExpert>(std::current_exception());
  }
}

std::string Runner::State::WhatUsersCodeRaised() const {
  try {
    throw;
  } catch (const HookError& error) {
    return error.has_place() || has_users_code ? error.what() : "";
  } catch (...) {
    return "";
  }
}

void Runner::State::TryAttempt(const PlanItem& item, int attempt, const StopRequest& stop,
                               EarlierAttempts& earlier, ItemResult& result) {
  constexpr int kMostRaised = 3;
  start_accepted = false;
  object_kind.clear();
  try {
    Attempt(item, attempt, stop, earlier, result);
    raised = 0;
  } catch (...) {
    const std::string raised_text = WhatUsersCodeRaised();
    const bool must_keep_start = run.keep == Keep::kFirst && start_accepted;
    if (!raised_text.empty() && must_keep_start) {
      std::throw_with_nested(
          Error("something else than the policy raised in the rollout, and an evaluation takes no "
                "other start in its place: " +
                raised_text));
    }
    if (raised_text.empty() || ++raised >= kMostRaised) throw;
    LogWarn(fmt::format("episode '{}', attempt {}: {}", item.id, attempt, raised_text));
    ++result.attempts;
    ++result.failures[raised_text];
    earlier.push_back({.object_kind = object_kind, .raised = true, .reason = raised_text});
  }
}

ItemResult Runner::Run(const PlanItem& item, const StopRequest& stop) {
  const RunConfig& run = state_->run;
  if (!state_->sampler) throw Error(fmt::format("run '{}': its runner is gone", run.run));
  ItemResult result{.item = item, .robot = run.robot.config.name};
  const DatasetLock lock = state_->Enter();
  if (state_->parts.stores && IsComplete(run, item)) {
    result.committed = result.resumed = true;
    result.success = LookForItem(run, item).success;
    result.complete = result.success || run.keep == Keep::kFirst;
    return result;
  }
  EarlierAttempts earlier;
  state_->raised = 0;
  state_->refused = {};
  const auto is_made = [&] {
    return result.success || (run.keep == Keep::kFirst && result.accepted > 0);
  };
  const int attempts = std::max(run.max_attempts, item.first_attempt + 1);
  for (int attempt = item.first_attempt; attempt < attempts && !is_made(); ++attempt) {
    if (ShouldStop(stop)) result.stopped = true;
    if (result.stopped) return result;
    const bool keeps_all = run.keep == Keep::kAll && state_->parts.stores;
    if (const auto kept = keeps_all ? KeptAttempt(run, item, attempt) : std::nullopt)
      AddKept(result, *kept, earlier);
    else
      state_->TryAttempt(item, attempt, stop, earlier, result);
  }
  result.complete = is_made();
  if (result.accepted > 0) result.advice.clear();
  if (result.accepted > 0 || result.out_of_reach == 0) return result;
  if (const std::string& where = state_->Advice(); !where.empty())
    result.advice += (result.advice.empty() ? "" : "; ") + where;
  return result;
}

}  // namespace robocell
