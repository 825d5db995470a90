#include "robocell/rollout/env_recorder.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>
#include <utility>
#include <nlohmann/json.hpp>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/log.h"
#include "robocell/base/make_directories.h"
#include "robocell/base/ratio.h"
#include "robocell/base/suggestions.h"
#include "robocell/data/dataset.h"
#include "robocell/data/dataset_folder.h"
#include "robocell/data/dataset_lock.h"
#include "robocell/data/episode_files.h"
#include "robocell/data/leftovers.h"
#include "robocell/features/chosen_features.h"
#include "robocell/rollout/env_of_episode.h"
#include "robocell/rollout/episode_reading.h"
#include "robocell/rollout/episode_recording.h"
#include "robocell/rollout/randomized_record.h"
#include "robocell/rollout/recorded_scene.h"
#include "robocell/spec/yaml.h"
#include "robocell/task/task_calls.h"
#include "robocell/task/task_features.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

// Names in the order of EndReason.
constexpr std::array kEndReasons = {
    EndReason::kDiverged, EndReason::kCollision, EndReason::kIkFailed, EndReason::kArrived,
    EndReason::kSettled,  EndReason::kTimeout,   EndReason::kStopped};

// The frame rate of videos. Steps that end at arrivals have no fixed rate: their frames play at the
// rate of the configuration.
Ratio RateOfRows(const EnvConfig& config) { return RatioOf(config.sim.frequency); }

// The frames that an environment shows, and when they were taken.
struct ShownFrames {
  void Take(const Env& env) {
    images = env.frames();
    times.clear();
    for (const CellImage& image : images) times.push_back(image.time);
  }

  std::vector<CellImage> images;
  std::vector<double> times;
};

// The constant description of all episodes of one scene; hashing models takes a while.
struct SceneDescription {
  uint64_t generation = 0;
  PortableScene portable;
  std::string config;  // the environment's, as YAML with portable names
};

std::string MetadataOf(const Env& env, const EnvRecorderOptions& options,
                       const SceneDescription& scene) {
  const EnvConfig& config = env.config();
  Json environment = {{"name", config.name}, {"config", scene.config}};
  if (!config.variations.empty()) {
    EnvConfig varied;
    varied.variations = config.variations;
    environment["variations"] = ToYaml(varied);
  }
  environment["code"] = CodeRecord(config);
  environment["start"] = env.state().ticks == 0 ? "reset" : "state";
  if (!config.saved_scene.empty()) environment["saved_scene"] = true;
  const double step_ms = env.scene().timestep() * 1000;
  internal::EpisodeRates rates{.control_ms = step_ms, .sim_ms = step_ms};
  if (config.sim.async_control) rates.rows = RateOfRows(config);
  Json meta = internal::EpisodeMetadata(env.scene(), scene.portable, env.instruction(), rates);
  meta["environment"] = environment;
  if (!env.randomized().empty())
    meta[internal::kRandomized] = internal::RandomizedRecord(env.randomized());
  meta["user"] = Json::parse(options.metadata_json);
  meta["task"] = config.task ? config.task->kind() : "";
  return meta.dump();
}

std::vector<std::string> SubtasksOf(const Env& env) {
  if (!env.task()) return {};
  return internal::TaskCalls(*env.task()).Subtasks();
}

// The form of the actions of an episode.
enum class ActionForm {
  kOwn,    // those of the environment (Env::Step), recorded as `action/...`
  kNamed,  // commands by the names of features (Env::Act), recorded as those of the cell only
};

const FeatureSchema& OwnActions(const Env& env, ActionForm form) {
  static const FeatureSchema none;
  return form == ActionForm::kOwn ? env.layout().commanded : none;
}

// An episode that is being recorded.
class EnvEpisode {
 public:
  EnvEpisode(const Env& env, ActionForm form, const fs::path& dataset, const std::string& id,
             const EnvRecorderOptions& options, const SceneDescription& scene)
      : env_(env),
        form_(form),
        nu_(static_cast<size_t>(env.scene().model()->nu)),
        has_images_(options.images),
        features_(RecordedFeatures(env)),
        recording_(env.scene().inner(),  // a second handle would keep the environment alive
                   {.observed = features_.observed(),
                    .commanded = features_.commanded(),
                    .more = {&env.layout().observed, &OwnActions(env, form)},
                    .subtasks = SubtasksOf(env)}) {
    if (has_images_) {
      begun_.shown.Take(env);
      recording_.AddCameras(begun_.shown.images, RateOfRows(env.config()),
                            internal::FrameTimes::kOwn);
    }
    AddLabels();
    const std::vector<double> state = env.state().numbers();
    const ConstantSpec env_state = {
        .column = {.name = std::string(kEnvStateColumn),
                   .shape = {static_cast<int64_t>(state.size())},
                   .description = "The environment's state before the first action: the numbers "
                                  "of an EnvState."},
        .values = state};
    recording_.Begin(dataset, id, MetadataOf(env, options, scene), scene.portable, {env_state});
  }

  void RequireForm(ActionForm form) const {
    if (form == form_) return;
    throw ArgumentError(fmt::format(
        "environment '{}': this episode is recorded with {}; save it, and reset, before the form "
        "of the actions changes",
        env_.config().name,
        form_ == ActionForm::kOwn ? "the environment's own actions" : "commands by name"));
  }
  // Begins a step; `action` is empty for commands by name.
  void Begin(std::span<const double> action) {
    recording_.RequireSameScene("environment '" + env_.config().name + "'",
                                "save it, and reset, before the scene changes");
    const std::span<const double> state = features_.ReadState();
    begun_.state.assign(state.begin(), state.end());
    begun_.seen.assign(env_.observation().begin(), env_.observation().end());
    begun_.action.assign(action.begin(), action.end());
    if (has_images_) begun_.shown.Take(env_);
    ForgetTicks();
  }
  void ForgetTicks() { begun_.times.clear(), begun_.ctrl.clear(); }
  void Tick(const mjData* data) {
    begun_.times.push_back(data->time);
    begun_.ctrl.insert(begun_.ctrl.end(), data->ctrl, data->ctrl + nu_);
  }
  // Ends the step, which shows that the previous row was not the last one.
  void End(const EnvStep& step) {
    const std::span<const double> commands = features_.ReadActions();
    begun_.commands.assign(commands.begin(), commands.end());
    after_.assign(env_.observation().begin(), env_.observation().end());
    warnings_ = recording_.warnings();
    const TaskVerdict& verdict = step;
    begun_.outcome = {verdict,
                      {.terminated = step.success || step.reason == EndReason::kDiverged,
                       .ik_failed = !step.ik_failed.empty(),
                       .warnings = warnings_.total()}};
    begun_.reason = step.reason;
    divergence_ = step.message;
    if (rows_ > 0) Write(ended_);
    std::swap(begun_, ended_);
    ++rows_;
  }
  int rows() const { return rows_; }

  // Commits an episode that has rows; the last row is written with the end of the episode.
  void Commit(const EnvEpisodeEnd& end) {
    const bool diverged = ended_.reason == EndReason::kDiverged;
    internal::RowOutcome& last = ended_.outcome;
    if (end.success) last.success = *end.success;
    last.terminated = last.success || diverged;
    last.truncated = !last.terminated;
    Write(ended_);
    EpisodeSummary summary{.success = last.success,
                           .terminated = last.terminated,
                           .truncated = last.truncated,
                           .end_reason = end.reason};
    if (end.reason.empty())
      summary.end_reason = last.success ? "success" : diverged ? "diverged" : "stopped";
    if (diverged) summary.warnings.push_back(divergence_);
    if (warnings_.total() > 0) summary.warnings.push_back(warnings_.Text());
    if (!diverged) summary.results_json = FinalObservation();
    recording_.Commit(summary);
  }

 private:
  enum { kObserved, kRequested };  // the further columns of a row

  struct Row {
    std::vector<double> state, commands, seen, action, times, ctrl;
    ShownFrames shown;
    internal::RowOutcome outcome;
    EndReason reason = EndReason::kTimeout;
  };

  // Returns the observation after the last action, which has no row of its own.
  std::string FinalObservation() const {
    Json final = Json::object();
    std::span<const double> rest = after_;
    for (const Feature& feature : env_.layout().observed.features()) {
      const auto size = static_cast<size_t>(feature.size());
      final[feature.column.name] = std::vector<double>(rest.begin(), rest.begin() + feature.size());
      rest = rest.subspan(size);
    }
    return Json{{kFinalObservation, final}}.dump();
  }

  void AddLabels() {
    std::vector<std::string> reasons;
    for (const EndReason reason : kEndReasons) reasons.emplace_back(ToString(reason));
    constexpr const char* kSource = "env recorder";
    reason_column_ = recording_.AddLabel({.name = "step_reason",
                                          .type = ColumnType::kInt32,
                                          .values = std::move(reasons),
                                          .description = "Why the step ended."},
                                         kSource);
    tick_column_ = recording_.AddLabel({.name = std::string(kControlTickColumn),
                                        .type = ColumnType::kInt64,
                                        .description = "The first row of the table `control` that "
                                                       "belongs to this one."},
                                       kSource);
  }

  void Write(const Row& row) {
    recording_.PutState(row.state, 0);
    recording_.PutCommands(row.commands);
    recording_.PutMore(kObserved, row.seen);
    recording_.PutMore(kRequested, row.action);
    recording_.PutOutcome(row.outcome);
    recording_.writer().Put(
        reason_column_,
        static_cast<int32_t>(std::ranges::find(kEndReasons, row.reason) - kEndReasons.begin()));
    recording_.writer().Put(tick_column_, ticks_);
    recording_.PutImages(row.shown.images, row.shown.times);
    recording_.EndRow();
    for (size_t i = 0; i < row.times.size(); ++i)
      recording_.PutControl(row.times[i], std::span(row.ctrl).subspan(i * nu_, nu_));
    ticks_ += static_cast<int64_t>(row.times.size());
  }

  const Env& env_;
  ActionForm form_;
  size_t nu_;
  bool has_images_;
  CellFeatures features_;
  internal::EpisodeRecording recording_;
  ColumnId reason_column_, tick_column_;

  // The row that has begun, and the last one that ended. A row is not written before the next one
  // has ended too: a step that an error ends is not a row.
  Row begun_, ended_;
  std::vector<double> after_;
  std::string divergence_;
  EngineWarnings warnings_;
  int rows_ = 0;
  int64_t ticks_ = 0;
};

// Returns the number after the highest of "<prefix>-000017".
int64_t NextNumber(const fs::path& dataset, const std::string& prefix) {
  int64_t next = 0;
  for (const std::string& name : FolderNames(dataset)) {
    if (!name.starts_with(prefix + "-")) continue;
    const std::string_view digits = std::string_view(name).substr(prefix.size() + 1);
    int64_t number = 0;
    const auto [end, error] = std::from_chars(digits.begin(), digits.end(), number);
    if (error == std::errc() && end == digits.end()) next = std::max(next, number + 1);
  }
  return next;
}

// Returns the name of the batch that "cell[3]" is a copy of, or the name itself.
std::string_view NameOfBatch(std::string_view name) {
  return name.ends_with(']') ? name.substr(0, name.rfind('[')) : name;
}

// All episodes of a dataset belong to one environment, or to the copies of one batch.
void RequireSameEnv(const fs::path& dataset, const Env& env) {
  const Dataset all(dataset);
  if (all.size() == 0 || !IsOfEnv(all.At(0))) return;
  const Episode first = all.At(0);
  EnvConfig config = env.config();
  const std::string theirs =
      internal::EpisodeJson::Metadata(first).At("environment").At("name").AsText();
  if (NameOfBatch(theirs) == NameOfBatch(config.name)) config.name = theirs;
  const std::vector<std::string> differences = DifferencesFromEpisode(config, first);
  if (differences.empty()) return;
  throw ArgumentError(fmt::format(
      "environment '{}' differs from the one whose episodes are in '{}': {}; choose another folder",
      env.config().name, dataset.string(), fmt::join(differences, "; ")));
}

void RequireNoRun(const fs::path& dataset) {
  if (!ReadManifest(dataset)) return;
  throw ArgumentError(
      fmt::format("'{}' is the dataset of a run, whose episodes are those of its plan; record "
                  "into another folder",
                  dataset.string()));
}

void PrepareFolder(const fs::path& dataset, const Env& env) {
  internal::MakeDirectories(dataset, "the dataset's folder");
  const std::vector<std::string> names = FolderNames(dataset);
  const bool is_new = std::ranges::all_of(
      names, [](const std::string& name) { return name.starts_with(kLockFile); });
  if (!is_new) RequireDataset(dataset);
  RequireNoRun(dataset);
  if (!is_new) RequireSameEnv(dataset, env);
}

void RequireRecorderOptions(const EnvRecorderOptions& options) {
  if (!IsEpisodeId(options.prefix + "-000000"))
    throw ArgumentError(fmt::format(
        "'{}' cannot begin the ids of episodes, which are visible folders", options.prefix));
  const Json json = Json::parse(options.metadata_json, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object()) throw ArgumentError("metadata_json must be an object in JSON");
}

void RequireColour(const EnvConfig& config) {
  for (const CameraConfig& stream : config.cameras.drawn()) {
    if (stream.rgb) continue;
    throw ArgumentError(fmt::format(
        "environment '{}': stream '{}' has no colour images, so it cannot be recorded; set its "
        "`rgb: true`, or record without images",
        config.name, stream.name));
  }
}

}  // namespace

CellFeatures RecordedFeatures(const Env& env) {
  const Scene scene = env.scene().inner();  // the environment has the only handle
  const std::shared_ptr<const Task> lent(std::shared_ptr<void>(), env.task().get());
  return FeaturesOfCell(scene, RobotsOf(scene), lent,
                        internal::OwnAmong(env.config().features.names));
}

struct EnvRecorder::State : public EnvObserver {
  State(Env& its_env, fs::path its_dataset, EnvRecorderOptions its_options)
      : env(&its_env),
        recorded(its_env),
        dataset(std::move(its_dataset)),
        options(std::move(its_options)) {
    RequireRecorderOptions(options);
    if (options.images) RequireColour(env->config());
    PrepareFolder(dataset, *env);
    lock = DatasetLock::Numbering(dataset, options.prefix);
    RemoveLeftoversOfNumbering(dataset, options.prefix);
    next = NextNumber(dataset, options.prefix);
    env->AddObserver(this);
  }
  ~State() override {
    if (env) env->RemoveObserver(this);
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  void OnStart() override {
    Save({});
    is_waiting = false;
  }
  void OnAction(std::span<const double> action) override { Begin(ActionForm::kOwn, action); }
  void OnCommands(const Action&) override { Begin(ActionForm::kNamed, {}); }
  void Begin(ActionForm form, std::span<const double> action) {
    if (is_waiting) return;
    if (episode) episode->RequireForm(form);
    Try([&] {
      if (!episode) Start(form);
      episode->Begin(action);
    });
  }
  void OnControlTick(const mjModel*, const mjData* data) override {
    if (episode) episode->Tick(data);
  }
  void OnTakenBack() override {
    if (episode) episode->ForgetTicks();
  }
  void OnStep(const EnvStep& step) override {
    if (episode) Try([&] { episode->End(step); });
  }

  // An episode that cannot be written is discarded; the environment goes on with the next reset.
  template <class F>
  void Try(F&& f) {
    try {
      f();
    } catch (...) {
      Discard();
      throw;
    }
  }
  // Others may have written into the folder since the recorder was made. Once it has episodes of
  // this environment, a recorder of another one is refused: listing a large folder takes a while.
  void RequireOwnFolder() {
    RequireNoRun(dataset);
    if (has_own_episodes) return;
    const std::vector<std::string> names = FolderNames(dataset);
    const auto is_hidden = [](const std::string& name) { return name.starts_with("."); };
    if (std::ranges::all_of(names, is_hidden)) return;
    RequireSameEnv(dataset, recorded);
    has_own_episodes = true;
  }
  void Start(ActionForm form) {
    RequireOwnFolder();
    if (!scene || scene->generation != env->scene().generation()) {
      scene = {.generation = env->scene().generation(),
               .portable = MakePortable(env->scene().spec()),
               .config = PortableConfig(env->config())};
    }
    episode = std::make_unique<EnvEpisode>(
        *env, form, dataset, fmt::format("{}-{:06}", options.prefix, next), options, *scene);
  }
  std::optional<std::string> Save(const EnvEpisodeEnd& end) {
    is_waiting = true;
    const std::unique_ptr<EnvEpisode> ended = std::move(episode);
    if (!ended || ended->rows() == 0) return std::nullopt;
    RequireOwnFolder();
    ended->Commit(end);
    has_own_episodes = true;
    episodes.push_back(fmt::format("{}-{:06}", options.prefix, next++));
    return episodes.back();
  }
  void Discard() {
    is_waiting = true;
    episode.reset();
  }

  Env* env;  // null when it is closed
  const Env& recorded;
  fs::path dataset;
  EnvRecorderOptions options;
  std::optional<DatasetLock> lock;
  int64_t next = 0;
  std::optional<SceneDescription> scene;
  std::unique_ptr<EnvEpisode> episode;
  bool is_waiting = false;        // true while it waits for a reset
  bool has_own_episodes = false;  // true once the folder was seen to have this environment's
  std::vector<std::string> episodes;
};

EnvRecorder::EnvRecorder(Env& env, const fs::path& dataset, EnvRecorderOptions options)
    : state_(std::make_unique<State>(env, dataset, std::move(options))) {}

EnvRecorder::~EnvRecorder() {
  if (rows() == 0) return;
  LogWarn(
      fmt::format("'{}': the recorder of environment '{}' was not closed; {} not saved "
                  "{} gone",
                  dataset().string(), state_->env->config().name, Counted(rows(), "step"),
                  rows() == 1 ? "is" : "are"));
}

std::optional<std::string> EnvRecorder::Save(const EnvEpisodeEnd& end) {
  if (closed()) throw ClosedError("the recorder of '" + dataset().string() + "' is closed");
  return state_->Save(end);
}

void EnvRecorder::Discard() { state_->Discard(); }

void EnvRecorder::Close() {
  if (closed()) return;
  std::exchange(state_->env, nullptr)->RemoveObserver(state_.get());
  const std::optional<DatasetLock> lock = std::exchange(state_->lock, std::nullopt);
  state_->Save({});
}

bool EnvRecorder::closed() const { return !state_->env; }
const fs::path& EnvRecorder::dataset() const { return state_->dataset; }
const std::vector<std::string>& EnvRecorder::episodes() const { return state_->episodes; }
int EnvRecorder::rows() const { return state_->episode ? state_->episode->rows() : 0; }

}  // namespace robocell
