#include "robocell/rollout/rollout_recording.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <memory>
#include <mutex>
#include <utility>
#include <nlohmann/json.hpp>

#include "robocell/base/log.h"
#include "robocell/features/cell_images.h"
#include "robocell/media/video_writer.h"
#include "robocell/rollout/randomized_record.h"
#include "robocell/task/task_calls.h"
#include "robocell/task/task_judge.h"

namespace robocell::internal {
namespace {

// Adds what is known of the start to what was known before the rollout.
std::string Metadata(const RunConfig& run, const EpisodeStart& start, const PortableScene& portable,
                     const RolloutOptions& options) {
  const std::string instruction = TaskCalls(*start.task).Instruction();
  WarnOfNoWords(*start.task, run.task.kind(), instruction);
  const Ratio sim_ms = run.rates.timestep() * 1000;
  auto meta = EpisodeMetadata(start.scene, portable, instruction,
                              {.control_ms = (sim_ms * run.rates.sim_steps()).value(),
                               .sim_ms = sim_ms.value(),
                               .rows = run.rates.policy_rate()});
  meta["target_object"] = start.target_object;
  meta["object_kinds"] = start.object_kinds;
  if (options.renderer) meta["renderer"] = options.renderer->description();
  if (!start.randomized.empty()) meta[kRandomized] = RandomizedRecord(start.randomized);
  auto all = nlohmann::json::parse(options.metadata_json);
  all.update(meta);
  return all.dump();
}

std::vector<const FeatureSchema*> MoreColumns(const RolloutParts& parts) {
  if (!parts.noise) return {};
  return {&parts.noise->intended()};
}

void NoteThatImagesAreLookedAt() {
  static std::once_flag once;
  std::call_once(once, [] {
    LogInfo("the policy looks at images, so they are drawn while it acts (render: kept)");
  });
}

}  // namespace

RolloutRecording::RolloutRecording(const RunConfig& run, const EpisodeStart& start, RunCell& in,
                                   const std::vector<std::string>& phases,
                                   const PortableScene& portable, const RolloutOptions& options,
                                   RolloutTimes& times, const RolloutParts& parts)
    : times_(times),
      options_(options),
      place_("scene '" + start.scene.name() + "'"),
      in_(in),
      parts_(parts),
      episode_(start.scene, {.observed = in.features.observed(),
                             .commanded = in.features.commanded(),
                             .more = MoreColumns(parts),
                             .phases = phases,
                             .subtasks = in.cell.subtasks()}),
      has_images_(!in.images.drawn().empty()),
      stores_(options.stores),
      draws_later_(has_images_ && stores_ && options.render == RenderWhen::kKept &&
                   !options.keep_failures),
      check_(start.scene, in.features.observed()) {
  drawers_.push_back(std::make_unique<Drawer>(start.scene, nullptr, in.images));
  for (Renderer* renderer : options.more_renderers) {
    auto own = std::make_unique<CellImages>(start.scene, run.cameras, renderer);
    CellImages& images = *own;
    drawers_.push_back(std::make_unique<Drawer>(start.scene, std::move(own), images));
  }
  in.cell.set_on_control_tick([this](const mjModel* m, const mjData* d) { PutControl(m, d); });
  if (has_images_) in.images.set_draw_at_look([this] { DrawForPolicy(); });
  if (!stores_) return;
  episode_.AddCameras(in.images.drawn(), run.rates.policy_rate());
  episode_.Describe(options.dataset, options.episode_id, Metadata(run, start, portable, options),
                    portable);
  if (!draws_later_) episode_.Open();
  if (!has_images_) return;
  StartQueue(draws_later_ ? RowQueue::Begin::kAtFinish : RowQueue::Begin::kAtOnce);
}

RolloutRecording::~RolloutRecording() {
  in_.images.set_draw_at_look({});
  in_.cell.set_on_control_tick({});
}

template <class Action>
bool RolloutRecording::WithEncoders(const Action& action) {
  constexpr int kMostRestarts = 2;  // in an episode; more kills are no accident
  for (bool again = false;; again = true) {
    try {
      return (!again || Restart()) && action(again);
    } catch (const EncoderDied& error) {
      if (++restarts_ > kMostRestarts) throw;
      LogWarn(fmt::format("{}; its images are drawn and encoded again", error.what()));
    }
  }
}

void RolloutRecording::PutState(const std::function<int()>& phase) {
  episode_.RequireSameScene(place_, "declare them in the scene (`parked`)");
  {
    const StageClock::Stage stage(clock_, times_.writing);
    const std::span<const double> state = in_.features.ReadState();
    row_.observed.assign(state.begin(), state.end());
    row_.phase = phase();
    row_.tick_times.clear();
    row_.ctrl.clear();
    row_.state = drawers_.front()->states.Take();
    row_.is_drawn = false;
  }
  if (is_looked_at_) DrawNow();
}

bool RolloutRecording::LetLook(const std::function<void()>& call) const {
  const auto rethrow_failure = [&] {
    if (draw_failure_) std::rethrow_exception(draw_failure_);
  };
  if (is_stopped_) return false;
  try {
    call();
  } catch (const HookError&) {  // it may come of the images that are missing
    rethrow_failure();
    if (!is_stopped_) throw;
  }
  rethrow_failure();
  return !is_stopped_;
}

bool RolloutRecording::PutOutcome(const RowOutcome& outcome) {
  if (!stores_) return true;
  const StageClock::Stage stage(clock_, has_images_ ? times_.rendering : times_.writing);
  const std::span<const double> actions = in_.features.ReadActions();
  row_.commanded.assign(actions.begin(), actions.end());
  if (parts_.noise)
    row_.intended.assign(parts_.noise->numbers().begin(), parts_.noise->numbers().end());
  row_.outcome = outcome;
  if (!has_images_) return Write(row_, 0), true;
  rows_.push_back(std::make_shared<EpisodeRow>(std::exchange(row_, {})));
  return WithEncoders(
      [&](bool again) { return again || queue_->Push(rows_.back(), options_.stop); });
}

void RolloutRecording::RequireWritten() {
  if (queue_ && !draws_later_) queue_->ThrowFailure();
}

bool RolloutRecording::Finish() {
  if (!has_images_) return true;
  const StageClock::Stage stage(clock_, times_.rendering);
  return FinishRows();
}

bool RolloutRecording::Commit(const EpisodeSummary& summary) {
  const StageClock::Stage stage(clock_, times_.writing);
  return WithEncoders([&](bool again) {
    if (again && !queue_->Finish(options_.stop)) return false;
    episode_.Commit(summary);
    return true;
  });
}

void RolloutRecording::PutControl(const mjModel* model, const mjData* data) {
  const StageClock::Stage stage(clock_, times_.writing);
  if (stores_) {
    row_.tick_times.push_back(data->time);
    row_.ctrl.insert(row_.ctrl.end(), data->ctrl, data->ctrl + model->nu);
  }
  if (parts_.replay) parts_.replay->Put({data->ctrl, static_cast<size_t>(model->nu)});
}

void RolloutRecording::Open() {
  if (!episode_.is_open()) episode_.Open();
}

bool RolloutRecording::FinishRows() {
  return WithEncoders([&](bool) {
    Open();
    return queue_->Finish(options_.stop);
  });
}

bool RolloutRecording::Restart() {
  queue_.reset();
  episode_.Open();
  StartQueue(RowQueue::Begin::kAtOnce);
  for (const std::shared_ptr<EpisodeRow>& row : rows_) {
    row->is_drawn = false;
    if (!queue_->Push(row, options_.stop)) return false;
  }
  return true;
}

void RolloutRecording::StartQueue(RowQueue::Begin begin) {
  queue_.emplace(
      RowQueue::Work{.draw = [this](EpisodeRow& row, int thread) { Draw(row, thread); },
                     .write = [this](EpisodeRow& row, int thread) { Write(row, thread); },
                     .threads = static_cast<int>(drawers_.size())},
      begin);
}

void RolloutRecording::Draw(EpisodeRow& row, int thread) {
  if (!row.is_drawn) drawers_[thread]->states.Draw(row.state);
}

void RolloutRecording::Write(EpisodeRow& row, int thread) {
  episode_.PutState(row.observed, row.phase);
  if (has_images_) {
    Drawer& by = *drawers_[row.is_drawn ? 0 : thread];
    check_.Require(options_.episode_id, episode_.writer().rows(), row.observed, by.states);
    episode_.PutImages(by.images.drawn());
  }
  const size_t nu = row.tick_times.empty() ? 0 : row.ctrl.size() / row.tick_times.size();
  for (size_t i = 0; i < row.tick_times.size(); ++i)
    episode_.PutControl(row.tick_times[i], std::span(row.ctrl).subspan(i * nu, nu));
  episode_.PutCommands(row.commanded);
  if (parts_.noise) episode_.PutMore(0, row.intended);
  episode_.PutOutcome(row.outcome);
  episode_.EndRow();
}

void RolloutRecording::DrawForPolicy() {
  try {
    if (draws_later_) NoteThatImagesAreLookedAt();
    DrawNow();
    is_looked_at_ = true;
  } catch (...) {  // within a call of the policy, whose error it would be
    draw_failure_ = std::current_exception();
  }
}

void RolloutRecording::DrawNow() {
  if (row_.is_drawn) return;
  const StageClock::Stage stage(clock_, times_.rendering);
  if (stores_ && !FinishRows()) {  // the cameras keep one set of images
    is_stopped_ = true;
    return queue_.reset();  // so that nobody draws while the policy looks
  }
  drawers_.front()->states.Draw(row_.state);
  row_.is_drawn = true;
}

}  // namespace robocell::internal
