#include "robocell/env/env_batch.h"

#include <unistd.h>
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <atomic>
#include <deque>
#include <exception>
#include <thread>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/base/worker_threads.h"
#include "robocell/env/env_cameras.h"
#include "robocell/env/env_scene.h"
#include "robocell/features/cell_features.h"

namespace robocell {
namespace {

std::string BatchPlace(const EnvConfig& config) {
  return "batch of environment '" + config.name + "'";
}

void RequireBatch(const EnvConfig& config, int count, std::optional<int> max_episode_steps) {
  const std::string place = BatchPlace(config);
  if (count < 1) throw ArgumentError(fmt::format("{}: {} copies; at least 1", place, count));
  if (max_episode_steps && *max_episode_steps < 1) {
    throw ArgumentError(fmt::format("{}: max_episode_steps is {}; at least 1, or leave it out",
                                    place, *max_episode_steps));
  }
}

// Copies whose models differ have one each.
bool HasOwnModels(const EnvConfig& config) {
  return !config.variations.empty() || config.randomize.has_value();
}

// Colours are written to a copy of the first model; without variations all copies use the first.
std::shared_ptr<internal::SharedDrawing> NewDrawing(const EnvConfig& config, const mjModel* model) {
  auto drawing = std::make_shared<internal::SharedDrawing>();
  drawing->renderer = MakeRenderer(
      {.backend = config.cameras.renderer.backend, .quality = config.cameras.renderer.quality});
  if (HasOwnModels(config)) drawing->model = CopyModel(model);
  drawing->has_looks = config.randomize.has_value();
  drawing->renderer->SetModel(drawing->model ? drawing->model.get() : model);
  return drawing;
}

// Returns the least memory of a copy, bytes: the engine's data and, with a model of its own, the
// arrays.
double BytesOfCopy(const Scene& scene, bool own_model) {
  const double data =
      static_cast<double>(sizeof(mjData)) + static_cast<double>(scene.data()->nbuffer);
  return own_model ? data + static_cast<double>(mj_sizeModel(scene.model())) : data;
}

double BytesOfMachine() {
  return static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

// Checks before the memory is full, which would kill the process without a message.
void RequireMemory(const EnvConfig& config, int count, double bytes_of_copy) {
  const double need = count * bytes_of_copy, there = BytesOfMachine();
  if (need <= there) return;
  throw ArgumentError(fmt::format(
      "{}: {} copies need {:.3g} GB of memory or more, {:.3g} MB each; this machine has {:.3g} GB",
      BatchPlace(config), count, need / 1e9, bytes_of_copy / 1e6, there / 1e9));
}

// Tasks can have other objects in each episode; a matrix has the same columns for all copies.
void RequireSameColumns(const EnvConfig& config, int copy, const FeatureSchema& first,
                        const FeatureSchema& own) {
  const auto is_same = [](const Feature& a, const Feature& b) {
    return a.column.name == b.column.name && a.column.shape == b.column.shape;
  };
  if (std::ranges::equal(first.features(), own.features(), is_same)) return;
  throw Error(
      fmt::format("{}: the features of copy {} are not those of copy 0: {}; read them of "
                  "each copy by itself",
                  BatchPlace(config), copy,
                  own.DifferenceFrom(first, fmt::format("in copy {}", copy), "in copy 0")));
}

bool Holds(const std::vector<bool>& which, int i) { return !which.empty() && which[i]; }

// Calls the poll on the caller's thread; its exception ends the work of all threads.
class Interruption {
 public:
  explicit Interruption(const std::function<void()>& poll) : poll_(poll) {}
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  void operator()() {
    if (interrupted_) throw Error("the step of a batch was interrupted");
    if (std::this_thread::get_id() != caller_) return;
    try {
      poll_();
    } catch (...) {
      thrown_ = std::current_exception();
      interrupted_ = true;
      throw;
    }
  }
  // Rethrows the poll's exception, if any, when all threads are done.
  void Rethrow() const {
    if (thrown_) std::rethrow_exception(thrown_);
  }

 private:
  const std::function<void()>& poll_;
  const std::thread::id caller_ = std::this_thread::get_id();
  std::atomic<bool> interrupted_ = false;
  std::exception_ptr thrown_;  // written and read by the caller's thread
};

}  // namespace

EnvBatch::EnvBatch(const EnvConfig& config, int count, int threads,
                   std::optional<int> max_episode_steps, const DataFactory& factory)
    : config_(config), max_episode_steps_(max_episode_steps) {
  RequireBatch(config, count, max_episode_steps);
  const std::shared_ptr<CompiledScene> compiled = CompileEnvScene(config);
  const bool shared = !HasOwnModels(config);
  const std::shared_ptr<internal::SharedDrawing> drawing =
      config.cameras.drawn().empty() ? nullptr : NewDrawing(config, compiled->model());
  compiled->Freeze();
  for (int i = 0; i < count; ++i) {
    EnvConfig own = config;
    own.name = fmt::format("{}[{}]", config.name, i);
    Scene scene = Scene::FromCompiled(shared ? compiled : compiled->Copy(), factory);
    envs_.push_back(std::make_unique<Env>(std::move(own), std::move(scene), i, drawing));
    if (i == 0) RequireMemory(config, count, BytesOfCopy(envs_.front()->scene(), !shared));
  }
  episode_steps_.resize(count);
  observations_.resize(static_cast<size_t>(count) * layout().observation.size());
  step_.reward.resize(count);
  step_.terminated.resize(count);
  step_.truncated.resize(count);
  step_.steps.resize(count);
  workers_ = std::make_unique<internal::WorkerThreads>(threads, count);
}

EnvBatch::~EnvBatch() = default;

void EnvBatch::RequireOpen() const {
  if (workers_) return;
  throw ClosedError(BatchPlace(config_) + " is closed");
}

void EnvBatch::Close() {
  std::deque<SceneUse::Claim> claims;
  for (const auto& env : envs_) claims.emplace_back(env->scene().use(), "EnvBatch.close");
  workers_.reset();
  for (const std::unique_ptr<Env>& env : envs_) Scene(env->scene()).Close();
}

std::vector<std::string> EnvBatch::instructions() const {
  std::vector<std::string> out;
  for (const std::unique_ptr<Env>& env : envs_) out.push_back(env->instruction());
  return out;
}

std::vector<uint8_t> EnvBatch::Draw(const CameraView& camera, int width, int height) {
  RequireOpen();
  RequireImageSize(width, height);
  if (!pictures_) pictures_ = NewDrawing(config_, envs_.front()->scene().model());
  const size_t one = size_t{3} * static_cast<size_t>(width) * static_cast<size_t>(height);
  std::vector<uint8_t> rgb(one * envs_.size());
  for (size_t i = 0; i < envs_.size(); ++i) {
    const SceneUse::Claim claim(envs_[i]->scene().use(), "EnvBatch.draw");
    pictures_->TakeColours(envs_[i]->scene().model());
    pictures_->renderer->Render(envs_[i]->scene().data(),
                                {.camera = camera, .width = width, .height = height},
                                {.rgb = std::span(rgb).subspan(i * one, one)});
  }
  return rgb;
}

void EnvBatch::DrawFrames() {
  if (envs_.front()->frames().empty()) return;
  for (const auto& env : envs_) {
    const SceneUse::Claim claim(env->scene().use(), "EnvBatch.step");
    env->DrawFrames();
  }
}

void EnvBatch::ForEach(const std::function<void(int)>& work) { workers_->Run(size(), work); }

void EnvBatch::CopyObservation(int i) {
  const std::span<const double> seen = envs_[i]->observation();
  std::copy(seen.begin(), seen.end(), observations_.begin() + static_cast<long>(i * seen.size()));
}

void EnvBatch::ResetOne(int i, const EnvResetOptions& options) {
  envs_[i]->Reset(options);
  episode_steps_[i] = 0;
  step_.reward[i] = 0;
  step_.terminated[i] = step_.truncated[i] = 0;
  step_.steps[i] = {};
  CopyObservation(i);
}

void EnvBatch::StepOne(int i, const MakeStep& make, const std::function<void()>& poll) {
  const EnvStep& step = step_.steps[i] = make(i, poll);
  ++episode_steps_[i];
  step_.reward[i] = step.reward;
  step_.terminated[i] = step.success;
  step_.truncated[i] = step.reason == EndReason::kDiverged || step.reason == EndReason::kStopped ||
                       (max_episode_steps_ && episode_steps_[i] >= *max_episode_steps_);
  CopyObservation(i);
}

bool EnvBatch::ik_success(int i, size_t robot) const {
  const std::vector<std::string>& failed = step_.steps[i].ik_failed;
  return std::find(failed.begin(), failed.end(), layout().robots[robot].robot) == failed.end();
}

void EnvBatch::RequireSized(const char* call, size_t given, const char* what) const {
  if (given == 0 || given == envs_.size()) return;
  throw ArgumentError(
      fmt::format("{} of {}: {} for {} were given", call, Counted(size(), "copy"), what, given));
}

void EnvBatch::Reset(std::span<const std::optional<uint64_t>> seeds, const std::vector<bool>& which,
                     const std::optional<KeyframeChoice>& keyframe) {
  RequireOpen();
  RequireSized("reset", seeds.size(), "seeds");
  RequireSized("reset", which.size(), "choices");
  ForEach([&](int i) {
    if (!which.empty() && !which[i]) return;
    ResetOne(i, {.seed = seeds.empty() ? std::nullopt : seeds[i], .keyframe = keyframe});
  });
  DrawFrames();
}

const BatchStep& EnvBatch::Step(std::span<const double> actions,
                                const std::vector<bool>& reset_instead,
                                const std::function<void()>& poll) {
  RequireOpen();
  const auto width = static_cast<size_t>(layout().action.size());
  if (actions.size() != envs_.size() * width) {
    throw ArgumentError(
        fmt::format("step of {}: expected {} for each, got {} in all", Counted(size(), "copy"),
                    Counted(static_cast<int64_t>(width), "number"), actions.size()));
  }
  const auto own = [&](int i) { return actions.subspan(static_cast<size_t>(i) * width, width); };
  return StepAll(
      reset_instead, [&](int i) { envs_[i]->RequireAction(own(i)); },
      [&](int i, const std::function<void()>& poll_of_copy) {
        return envs_[i]->Step(own(i), poll_of_copy);
      },
      poll);
}

std::vector<EnvBatch::RowsByName> EnvBatch::CommandsOfCopies(const RowsByName& commands) {
  std::vector<RowsByName> own(envs_.size());
  const FeatureSchema& commanded = envs_.front()->features().commanded();
  for (const auto& [name, numbers] : commands) {
    const auto width = static_cast<size_t>(commanded.Find(name).size());
    if (numbers.size() != envs_.size() * width) {
      throw ArgumentError(fmt::format(
          "step of {}: expected {} of '{}' for each, got {} in all", Counted(size(), "copy"),
          Counted(static_cast<int64_t>(width), "number"), name, numbers.size()));
    }
    for (size_t i = 0; i < own.size(); ++i) {
      const auto begin = numbers.begin() + static_cast<long>(i * width);
      own[i][name].assign(begin, begin + static_cast<long>(width));
    }
  }
  return own;
}

const BatchStep& EnvBatch::Act(const RowsByName& commands, const std::vector<bool>& reset_instead,
                               const std::function<void()>& poll) {
  RequireOpen();
  const std::vector<RowsByName> own = CommandsOfCopies(commands);
  return StepAll(
      reset_instead, [&](int i) { envs_[i]->RequireCommands(own[i]); },
      [&](int i, const std::function<void()>& poll_of_copy) {
        return envs_[i]->Act(own[i], poll_of_copy);
      },
      poll);
}

EnvBatch::RowsByName EnvBatch::Row() {
  RequireOpen();
  const FeatureSchema schema = envs_.front()->features().observed();
  RowsByName rows;
  std::vector<std::span<double>> columns;  // in the order of the schema
  for (const Feature& feature : schema.features()) {
    std::vector<double>& column = rows[feature.column.name];
    column.resize(envs_.size() * static_cast<size_t>(feature.size()));
    columns.emplace_back(column);
  }
  ForEach([&](int i) {
    const SceneUse::Claim claim(envs_[i]->scene().use(), "EnvBatch.row");
    CellFeatures& features = envs_[i]->features();
    RequireSameColumns(config_, i, schema, features.observed());
    std::span<const double> rest = features.ReadState();
    for (const std::span<double> column : columns) {
      const size_t width = column.size() / envs_.size();
      std::ranges::copy(rest.first(width), column.subspan(i * width).begin());
      rest = rest.subspan(width);
    }
  });
  return rows;
}

const BatchStep& EnvBatch::StepAll(const std::vector<bool>& reset_instead,
                                   const std::function<void(int)>& require, const MakeStep& make,
                                   const std::function<void()>& poll) {
  RequireSized("step", reset_instead.size(), "choices");
  for (int i = 0; i < size(); ++i) {
    if (!Holds(reset_instead, i)) require(i);
  }
  Interruption interruption(poll);
  std::function<void()> ask;
  if (poll) ask = std::ref(interruption);
  const auto work = [&](int i) {
    if (ask) ask();
    if (Holds(reset_instead, i)) {
      ResetOne(i, {});
    } else {
      StepOne(i, make, ask);
    }
  };
  try {
    workers_->Run(size(), work, ask);
    DrawFrames();
  } catch (...) {
    // Some have stepped and some have not, and the caller cannot know which episodes ended.
    for (const std::unique_ptr<Env>& env : envs_) env->WantReset();
    interruption.Rethrow();
    throw;
  }
  return step_;
}

}  // namespace robocell
