#include "robocell/rollout/env_recorder.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>
#include <nlohmann/json.hpp>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/io_error.h"
#include "robocell/base/log.h"
#include "robocell/base/ratio.h"
#include "robocell/data/dataset.h"
#include "robocell/data/dataset_folder.h"
#include "robocell/data/dataset_lock.h"
#include "robocell/data/episode_files.h"
#include "robocell/data/leftovers.h"
#include "robocell/features/chosen_features.h"
#include "robocell/rollout/env_of_episode.h"
#include "robocell/rollout/episode_cameras.h"
#include "robocell/rollout/episode_columns.h"
#include "robocell/rollout/recorded_scene.h"
#include "robocell/spec/yaml.h"
#include "robocell/task/task_features.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

// In the order of EndReason.
constexpr std::array kEndReasons = {EndReason::kDiverged, EndReason::kCollision,
                                    EndReason::kIkFailed, EndReason::kArrived,
                                    EndReason::kSettled,  EndReason::kTimeout};

// The frame rate of videos. Steps that end at arrivals have no fixed rate: their frames play at the
// rate of the configuration.
Ratio RateOfRows(const EnvConfig& config) { return RatioOf(config.sim.frequency); }

// The frame that a stream shows.
struct ShownFrame {
  std::vector<uint8_t> rgb;
  std::vector<uint16_t> depth, bodies;
  std::array<double, 16> extrinsics = {};
  double time = 0;
};

// The streams of an environment as cameras of an episode: frames as they were shown.
class FrameColumns {
 public:
  FrameColumns(EpisodeSchema& schema, const Env& env) {
    for (const EnvFrame& frame : env.frames()) Add(schema, env, frame);
    if (std::ranges::any_of(env.frames(),
                            [](const EnvFrame& f) { return !f.segmentation.empty(); }))
      schema.SetSegmentLabels(internal::SegmentLabelsOf(env.scene()));
  }
  // Reads the current frames.
  void Take(const Env& env, std::vector<ShownFrame>& out) const {
    out.resize(streams_.size());
    for (size_t i = 0; i < streams_.size(); ++i) {
      ShownFrame& shown = out[i];
      const EnvFrame& frame = env.frames()[i];
      shown.rgb = frame.rgb;
      shown.depth = frame.depth_mm;
      shown.bodies.resize(frame.segmentation.size());
      std::ranges::transform(frame.segmentation, shown.bodies.begin(), [](int32_t body) {
        return body < 0 ? kNoSegment : static_cast<uint16_t>(body);
      });
      const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> pose = frame.camera.extrinsics();
      std::copy_n(pose.data(), 16, shown.extrinsics.begin());
      shown.time = frame.time;
    }
  }
  void Put(EpisodeWriter& writer, const std::vector<ShownFrame>& frames) const {
    for (size_t i = 0; i < streams_.size(); ++i) {
      const Stream& stream = streams_[i];
      const ShownFrame& shown = frames[i];
      writer.Put(stream.extrinsics_column, std::span<const double>(shown.extrinsics));
      writer.Put(stream.time_column, shown.time);
      writer.WriteFrame(stream.video, shown.rgb);
      if (!shown.depth.empty()) writer.WriteDepth(stream.video, shown.depth);
      if (!shown.bodies.empty()) writer.WriteSegmentation(stream.video, shown.bodies);
    }
  }

 private:
  struct Stream {
    CameraId video;
    ColumnId extrinsics_column, time_column;
  };

  void Add(EpisodeSchema& schema, const Env& env, const EnvFrame& frame) {
    const Ratio rate = RateOfRows(env.config());
    const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> k = frame.camera.intrinsics();
    std::array<double, 9> intrinsics = {};
    std::copy_n(k.data(), 9, intrinsics.begin());
    Stream stream;
    stream.video = schema.AddCamera({.name = frame.stream,
                                     .width = frame.width,
                                     .height = frame.height,
                                     .fps_num = static_cast<int>(rate.num),
                                     .fps_den = static_cast<int>(rate.den),
                                     .intrinsics = intrinsics,
                                     .depth = !frame.depth_mm.empty(),
                                     .segmentation = !frame.segmentation.empty()});
    const std::string path = "cameras/" + frame.stream + "/";
    stream.extrinsics_column = schema.AddColumn({.name = path + "extrinsics",
                                                 .shape = {4, 4},
                                                 .units = "m, 1",
                                                 .frame = "world -> camera, OpenCV axes"});
    stream.time_column = schema.AddColumn({.name = path + "time",
                                           .units = "s",
                                           .description = "When the frame was taken, since the "
                                                          "reset: streams with a rate of their own "
                                                          "show one until the next."});
    streams_.push_back(stream);
  }

  std::vector<Stream> streams_;
};

// The constant description of all episodes of one scene; hashing models takes a while.
struct SceneDescription {
  uint64_t generation = 0;
  PortableScene portable;
  std::string config;  // the environment's, as YAML with portable names
};

// An episode that is being recorded.
class EnvEpisode {
 public:
  EnvEpisode(const Env& env, const fs::path& dataset, const std::string& id,
             const EnvRecorderOptions& options, const SceneDescription& scene)
      : env_(env),
        nu_(static_cast<size_t>(env.scene().model()->nu)),
        generation_(env.scene().generation()),
        features_(RecordedFeatures(env)),
        state_columns_(schema_, features_.observed()),
        command_columns_(schema_, features_.commanded()),
        seen_columns_(schema_, env.layout().observed),
        asked_columns_(schema_, env.layout().commanded),
        outcome_(schema_, env.scene(), {},
                 env.task() ? env.task()->subtasks() : std::vector<std::string>()) {
    if (options.images) frames_.emplace(schema_, env);
    AddColumns();
    const std::vector<double> state = env.scene().state(), env_state = env.state().numbers();
    schema_.AddConstant(
        {.name = "initial_state",
         .shape = {static_cast<int64_t>(state.size())},
         .description = "The engine's full state before the first action (mjSTATE_INTEGRATION)."},
        state);
    schema_.AddConstant({.name = std::string(kEnvStateColumn),
                         .shape = {static_cast<int64_t>(env_state.size())},
                         .description = "The environment's state before the first action: the "
                                        "numbers of an EnvState."},
                        env_state);
    writer_.emplace(dataset, id, schema_,
                    EpisodeOptions{.metadata_json = Metadata(options, scene),
                                   .versions_json = Json{{"mujoco", mj_versionString()}}.dump(),
                                   .features = AllFeatures()});
    for (const auto& [name, files] : scene.portable.models) writer_->AddModel(name, files);
  }

  // Begins a step.
  void Begin(std::span<const double> action) {
    if (env_.scene().generation() != generation_) {
      throw Error(fmt::format(
          "environment '{}': objects were added or removed while an episode is recorded, whose "
          "rows have numbers for those it began with; save it, and reset, before the scene changes",
          env_.config().name));
    }
    const std::span<const double> state = features_.ReadState();
    begun_.state.assign(state.begin(), state.end());
    begun_.seen.assign(env_.observation().begin(), env_.observation().end());
    begun_.action.assign(action.begin(), action.end());
    if (frames_) frames_->Take(env_, begun_.frames);
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
    warnings_ = outcome_.warnings();
    begun_.outcome = {.reward = step.reward,
                      .progress = step.progress,
                      .subtask = step.subtask,
                      .success = step.success,
                      .terminated = step.success || step.reason == EndReason::kDiverged,
                      .ik_failed = !step.ik_failed.empty(),
                      .warnings = warnings_.total()};
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
    writer_->Commit(summary);
  }

 private:
  struct Row {
    std::vector<double> state, commands, seen, action, times, ctrl;
    std::vector<ShownFrame> frames;
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

  void AddColumns() {
    std::vector<std::string> reasons;
    for (const EndReason reason : kEndReasons) reasons.emplace_back(ToString(reason));
    const auto add = [&](ColumnSpec column) {
      labels_.Add({.column = column, .role = FeatureRole::kLabel, .source = "env recorder"});
      return schema_.AddColumn(std::move(column));
    };
    reason_column_ = add({.name = "step_reason",
                          .type = ColumnType::kInt32,
                          .values = std::move(reasons),
                          .description = "Why the step ended."});
    tick_column_ = add({.name = std::string(kControlTickColumn),
                        .type = ColumnType::kInt64,
                        .description = "The first row of the table `control` that belongs to this "
                                       "one."});
  }

  FeatureSchema AllFeatures() const {
    FeatureSchema all = features_.schema();
    for (const FeatureSchema* more :
         {&env_.layout().observed, &env_.layout().commanded, &outcome_.labels(), &labels_}) {
      for (const Feature& feature : more->features()) all.Add(feature);
    }
    return all;
  }

  std::string Metadata(const EnvRecorderOptions& options, const SceneDescription& scene) const {
    const EnvConfig& config = env_.config();
    Json environment = {{"name", config.name}, {"config", scene.config}};
    if (!config.variations.empty()) {
      EnvConfig varied;
      varied.variations = config.variations;
      environment["variations"] = ToYaml(varied);
    }
    environment["code"] = CodeRecord(config);
    environment["start"] = env_.state().ticks == 0 ? "reset" : "state";
    if (!config.saved_scene.empty()) environment["saved_scene"] = true;
    const double step_ms = env_.scene().timestep() * 1000;
    Json meta = {{"environment", environment},
                 {"user", Json::parse(options.metadata_json)},
                 {"instruction", env_.instruction()},
                 {"task", config.task ? config.task->kind() : ""},
                 {"scene_spec", ToYaml(scene.portable.spec)},
                 {"engine", EngineRecord(env_.scene())},
                 {"timestep", env_.scene().timestep()},
                 {"rates", {{"control_ms", step_ms}, {"sim_ms", step_ms}}}};
    if (config.sim.async_control) {
      const Ratio rate = RateOfRows(config);
      meta["rates"]["policy_ms"] = 1000 / rate.value();
      meta["rates"]["policy_hz"] = {rate.num, rate.den};
    }
    return meta.dump();
  }

  void Write(const Row& row) {
    EpisodeWriter& writer = *writer_;
    state_columns_.Put(writer, row.state);
    command_columns_.Put(writer, row.commands);
    seen_columns_.Put(writer, row.seen);
    asked_columns_.Put(writer, row.action);
    outcome_.PutPhase(writer, 0);
    outcome_.PutOutcome(writer, row.outcome);
    writer.Put(reason_column_, static_cast<int32_t>(std::ranges::find(kEndReasons, row.reason) -
                                                    kEndReasons.begin()));
    writer.Put(tick_column_, ticks_);
    if (frames_) frames_->Put(writer, row.frames);
    writer.EndRow();
    for (size_t i = 0; i < row.times.size(); ++i)
      outcome_.PutControl(writer, row.times[i], std::span(row.ctrl).subspan(i * nu_, nu_));
    ticks_ += static_cast<int64_t>(row.times.size());
  }

  const Env& env_;
  size_t nu_;
  uint64_t generation_;
  EpisodeSchema schema_;
  CellFeatures features_;
  internal::FeatureColumns state_columns_, command_columns_, seen_columns_, asked_columns_;
  internal::OutcomeColumns outcome_;
  FeatureSchema labels_;
  ColumnId reason_column_, tick_column_;
  std::optional<FrameColumns> frames_;
  std::optional<EpisodeWriter> writer_;

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

// All episodes of a dataset belong to one environment.
void RequireSameEnv(const fs::path& dataset, const Env& env) {
  const Dataset all(dataset);
  if (all.size() == 0 || !IsOfEnv(all.At(0))) return;
  const std::vector<std::string> differences = DifferencesFromEpisode(env.config(), all.At(0));
  if (differences.empty()) return;
  throw ArgumentError(fmt::format(
      "environment '{}' differs from the one whose episodes are in '{}': {}; choose another folder",
      env.config().name, dataset.string(), fmt::join(differences, "; ")));
}

void PrepareFolder(const fs::path& dataset, const Env& env) {
  std::error_code error;
  fs::create_directories(dataset, error);
  if (error) ThrowIoError("create the dataset's folder", dataset, error.value());
  const std::vector<std::string> names = FolderNames(dataset);
  const bool is_new = std::ranges::all_of(
      names, [](const std::string& name) { return name.starts_with(kLockFile); });
  if (!is_new) RequireDataset(dataset);
  if (ReadManifest(dataset)) {
    throw ArgumentError(fmt::format(
        "'{}' is the dataset of a run, whose episodes are those of its plan; record into a folder "
        "of its own",
        dataset.string()));
  }
  if (!is_new) RequireSameEnv(dataset, env);
}

void RequireRecorderOptions(const EnvRecorderOptions& options) {
  if (!IsEpisodeId(options.prefix))
    throw ArgumentError(fmt::format(
        "'{}' cannot begin the ids of episodes, which are visible folders", options.prefix));
  const Json json = Json::parse(options.metadata_json, nullptr, false);
  if (!json.is_object()) throw ArgumentError("metadata_json must be an object in JSON");
}

void RequireColour(const EnvConfig& config) {
  for (const CameraConfig& stream : config.cameras.streams) {
    if (stream.rgb) continue;
    throw ArgumentError(fmt::format(
        "environment '{}': stream '{}' has no colour images, so it cannot be recorded; set its "
        "`rgb: true`, or record without images",
        config.name, stream.name));
  }
}

}  // namespace

CellFeatures RecordedFeatures(const Env& env) {
  return FeaturesOfCell(env.scene(), RobotsOf(env.scene()), env.task(),
                        OwnAmong(env.config().features.names));
}

struct EnvRecorder::State : public EnvObserver {
  State(Env& its_env, fs::path its_dataset, EnvRecorderOptions its_options)
      : env(&its_env), dataset(std::move(its_dataset)), options(std::move(its_options)) {
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
  void OnAction(std::span<const double> action) override {
    if (is_waiting) return;
    Try([&] {
      if (!episode) Start();
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
  void Start() {
    if (!scene || scene->generation != env->scene().generation()) {
      scene = {.generation = env->scene().generation(),
               .portable = MakePortable(env->scene().spec()),
               .config = PortableConfig(env->config())};
    }
    episode = std::make_unique<EnvEpisode>(
        *env, dataset, fmt::format("{}-{:06}", options.prefix, next), options, *scene);
  }
  std::optional<std::string> Save(const EnvEpisodeEnd& end) {
    is_waiting = true;
    const std::unique_ptr<EnvEpisode> ended = std::move(episode);
    if (!ended || ended->rows() == 0) return std::nullopt;
    ended->Commit(end);
    episodes.push_back(fmt::format("{}-{:06}", options.prefix, next++));
    return episodes.back();
  }
  void Discard() {
    is_waiting = true;
    episode.reset();
  }

  Env* env;  // null when it is closed
  fs::path dataset;
  EnvRecorderOptions options;
  std::optional<DatasetLock> lock;
  int64_t next = 0;
  std::optional<SceneDescription> scene;
  std::unique_ptr<EnvEpisode> episode;
  bool is_waiting = false;  // for a reset
  std::vector<std::string> episodes;
};

EnvRecorder::EnvRecorder(Env& env, const fs::path& dataset, EnvRecorderOptions options)
    : state_(std::make_unique<State>(env, dataset, std::move(options))) {}

EnvRecorder::~EnvRecorder() {
  if (rows() == 0) return;
  LogWarn(
      fmt::format("'{}': the recorder of environment '{}' was not closed; the {} steps that "
                  "were not saved are gone",
                  dataset().string(), state_->env->config().name, rows()));
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
