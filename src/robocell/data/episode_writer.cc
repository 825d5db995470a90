#include "robocell/data/episode_writer.h"

#include <unistd.h>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <optional>
#include <system_error>
#include <utility>
#include <nlohmann/json.hpp>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/hash.h"
#include "robocell/base/host.h"
#include "robocell/base/io_error.h"
#include "robocell/base/names.h"
#include "robocell/base/paths.h"
#include "robocell/base/version.h"
#include "robocell/data/episode_files.h"
#include "robocell/data/episode_state.h"
#include "robocell/data/hdf5.h"
#include "robocell/data/model_store.h"
#include "robocell/data/self_hashed_json.h"
#include "robocell/data/steps_file.h"
#include "robocell/data/work_folder.h"
#include "robocell/media/ffmpeg.h"
#include "robocell/media/video_info.h"
#include "robocell/media/video_writer.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// The videos of one camera.
struct CameraFiles {
  VideoWriter colour;
  std::optional<VideoWriter> depth = {};
  std::optional<VideoWriter> segmentation = {};
};

enum class State { kOpen, kFailed, kCommitted, kAborted };

std::string UtcNow() {
  const auto now = std::chrono::system_clock::now();
  const auto seconds = std::chrono::floor<std::chrono::seconds>(now);
  const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(now - seconds).count();
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z",
                     fmt::gmtime(std::chrono::system_clock::to_time_t(seconds)), ms);
}

// A JSON object from the caller, with sorted keys.
Json ParseObject(const std::string& where, const std::string& what, const std::string& text) {
  try {
    const auto value = nlohmann::json::parse(text);
    if (!value.is_object()) {
      throw ArgumentError(
          fmt::format("{}: {} must be a JSON object, got {}", where, what, value.type_name()));
    }
    return Json::parse(value.dump());
  } catch (const nlohmann::json::exception& error) {
    throw ArgumentError(fmt::format("{}: {} is not JSON: {}", where, what, error.what()));
  }
}

}  // namespace

bool IsEpisodeId(std::string_view id) { return ValidFileName(id) && !id.starts_with('.'); }

struct EpisodeWriter::Impl {
  fs::path dataset;
  fs::path final;
  std::optional<WorkFolder> work;
  std::string id;
  std::string name;  // for messages
  std::string started = UtcNow();
  EpisodeSchema schema;
  Json metadata;
  Json features;  // what the columns are
  Json versions;
  std::unique_ptr<StepsFile> steps;
  std::vector<CameraFiles> videos;  // by the camera's number
  std::vector<std::string> extra_files;
  Json models = Json::object();
  std::vector<FileSet> model_files;  // of these
  State state = State::kOpen;
  std::string failure;

  ~Impl() { Remove(); }

  void Remove() noexcept {
    steps.reset();
    videos.clear();
    work.reset();
  }

  // Runs an action of the open episode; a failure ends the episode for good.
  template <typename Action>
  void Do(const char* call, Action action) {
    if (state == State::kFailed) throw IoError(failure);
    if (state != State::kOpen) {
      throw ClosedError(fmt::format("{}: {} after it was {}", name, call,
                                    state == State::kCommitted ? "committed" : "aborted"));
    }
    try {
      action();
    } catch (const ArgumentError&) {
      throw;  // the caller's mistake: nothing was changed
    } catch (const std::exception& error) {
      if (state == State::kCommitted) throw IoError(fmt::format("{}: {}", name, error.what()));
      Fail(error.what());
    }
  }

  [[noreturn]] void Fail(const std::string& reason) {
    state = State::kFailed;
    failure =
        fmt::format("{} is not saved: {}", name, WithSpaceHint(reason, dataset, BytesWritten()));
    Remove();
    throw IoError(failure);
  }

  // On the disk by now.
  uint64_t BytesWritten() const {
    uint64_t bytes = 0;
    std::error_code error;
    if (!work) return bytes;
    for (fs::directory_iterator it(work->path(), error), end; !error && it != end;
         it.increment(error)) {
      std::error_code gone;
      const uint64_t size = it->file_size(gone);
      if (!gone) bytes += size;
    }
    return bytes;
  }

  bool has_segmentation() const {
    const auto& all = schema.cameras();
    return std::any_of(all.begin(), all.end(),
                       [](const CameraEntry& camera) { return camera.stream.segmentation; });
  }
  void RequireLabels(std::span<const uint16_t> labels) const;
  void Open(const EpisodeOptions& options);
  void RequireFramesMatchRows() const;
  void RequireOnePerRow(const CameraEntry& camera, const char* what,
                        const VideoWriter& video) const;
  CameraFiles& VideosOf(CameraId camera);
  void CloseFiles();
  void Rename();
  Json Tables() const;
  Json Cameras() const;
  Json Segmentation() const;
  Json Files() const;
  Json Versions() const;
  Json Run(const Json& given) const;
  std::string Description(const EpisodeSummary& summary, const Json& results,
                          const Json& run) const;
};

void EpisodeWriter::Impl::Open(const EpisodeOptions& options) {
  work.emplace(dataset, id);
  steps = std::make_unique<StepsFile>(work->path() / kStepsFile, name, schema);
  for (const CameraEntry& camera : schema.cameras()) {
    const CameraStream& stream = camera.stream;
    VideoOptions video{.width = stream.width,
                       .height = stream.height,
                       .fps_num = stream.fps_num,
                       .fps_den = stream.fps_den,
                       .preset = options.video_preset,
                       .crf = options.video_crf,
                       .keyframe_interval = options.video_keyframe_interval};
    videos.push_back({.colour = VideoWriter(work->path() / VideoFile(stream.name), video)});
    video.kind = VideoKind::kGray16;
    if (stream.depth) videos.back().depth.emplace(work->path() / DepthFile(stream.name), video);
    if (stream.segmentation)
      videos.back().segmentation.emplace(work->path() / SegmentationFile(stream.name), video);
  }
}

void EpisodeWriter::Impl::RequireFramesMatchRows() const {
  if (steps->rows(kStepsTable) == 0) throw ArgumentError(fmt::format("{}: it has no row", name));
  for (size_t i = 0; i < videos.size(); ++i) {
    RequireOnePerRow(schema.cameras()[i], "frames", videos[i].colour);
    if (videos[i].depth) RequireOnePerRow(schema.cameras()[i], "depth frames", *videos[i].depth);
    if (videos[i].segmentation)
      RequireOnePerRow(schema.cameras()[i], "segmentation frames", *videos[i].segmentation);
  }
}

void EpisodeWriter::Impl::RequireOnePerRow(const CameraEntry& camera, const char* what,
                                           const VideoWriter& video) const {
  const int64_t rows = steps->rows(camera.table);
  if (video.frames() == rows) return;
  throw ArgumentError(fmt::format(
      "{}: camera '{}' has {} {} for the {} rows of table '{}'; each row needs one", name,
      camera.stream.name, video.frames(), what, rows, schema.tables()[camera.table.index].name));
}

void EpisodeWriter::Impl::CloseFiles() {
  steps->Close();
  for (CameraFiles& camera : videos) {
    camera.colour.Finish();
    if (camera.depth) camera.depth->Finish();
    if (camera.segmentation) camera.segmentation->Finish();
  }
  steps->VerifyContent();
}

// From the rename on the episode is there, whatever comes: a failed flush of the dataset's folder
// is told as what it is and takes nothing back.
void EpisodeWriter::Impl::Rename() {
  ::rmdir(final.c_str());  // an empty folder is in nobody's way; all else stays, and is told
  try {
    work->Commit(final);
  } catch (...) {
    if (work->committed()) state = State::kCommitted;
    throw;
  }
  state = State::kCommitted;
}

Json EpisodeWriter::Impl::Tables() const {
  Json tables = Json::object();
  for (size_t i = 0; i < schema.tables().size(); ++i) {
    tables[schema.tables()[i].name] = {{"rows", steps->rows({static_cast<int>(i)})}};
  }
  return tables;
}

Json EpisodeWriter::Impl::Cameras() const {
  Json cameras = Json::object();
  for (size_t i = 0; i < videos.size(); ++i) {
    const CameraEntry& camera = schema.cameras()[i];
    const CameraStream& stream = camera.stream;
    cameras[stream.name] = {{"file", VideoFile(stream.name)},
                            {"table", schema.tables()[camera.table.index].name},
                            {"frames", videos[i].colour.frames()},
                            {"width", stream.width},
                            {"height", stream.height},
                            {"fps", {stream.fps_num, stream.fps_den}}};
    if (videos[i].depth) {
      cameras[stream.name]["depth"] = {
          {"file", DepthFile(stream.name)}, {"frames", videos[i].depth->frames()}, {"units", "mm"}};
    }
    if (videos[i].segmentation) {
      cameras[stream.name]["segmentation"] = {{"file", SegmentationFile(stream.name)},
                                              {"frames", videos[i].segmentation->frames()}};
    }
  }
  return cameras;
}

// The labels of 0, 1, ...
Json EpisodeWriter::Impl::Segmentation() const {
  Json labels = Json::array();
  for (const SegmentLabel& label : schema.segment_labels())
    labels.push_back({{"name", label.name}, {"owner", label.owner}});
  return {{"none", kNoSegment}, {"labels", labels}};
}

Json EpisodeWriter::Impl::Files() const {
  std::vector<std::string> names = {std::string(kStepsFile)};
  for (const CameraEntry& camera : schema.cameras()) {
    names.push_back(VideoFile(camera.stream.name));
    if (camera.stream.depth) names.push_back(DepthFile(camera.stream.name));
    if (camera.stream.segmentation) names.push_back(SegmentationFile(camera.stream.name));
  }
  names.insert(names.end(), extra_files.begin(), extra_files.end());
  Json files = Json::object();
  for (const std::string& file : names) {
    files[file] = {{"bytes", fs::file_size(work->path() / file)},
                   {"sha256", Sha256File(work->path() / file)}};
  }
  return files;
}

Json EpisodeWriter::Impl::Versions() const {
  Json all = {{"robocell", std::string(Version())}, {"hdf5", hdf5::Version()}};
  if (!videos.empty()) {
    all["ffmpeg"] = FfmpegVersion();
    all["encoder"] = ReadVideoInfo(videos[0].colour.path()).encoder;
  }
  all.update(versions);
  return all;
}

Json EpisodeWriter::Impl::Run(const Json& given) const {
  Json run = {
      {"host", HostName()}, {"process", ::getpid()}, {"started", started}, {"finished", UtcNow()}};
  for (const auto& [key, value] : given.items()) {
    if (run.contains(key) || key == kJsonHash) {
      throw ArgumentError(
          fmt::format("{}: run_json must not have '{}', it is added by the writer", name, key));
    }
  }
  run.update(given);
  run[kJsonHash] = kHashPlaceholder;
  return run;
}

std::string EpisodeWriter::Impl::Description(const EpisodeSummary& summary, const Json& results,
                                             const Json& run) const {
  Json description = {{"format", kEpisodeFormat},
                      {"format_version", kEpisodeFormatVersion},
                      {"id", id},
                      {"success", summary.success},
                      {"terminated", summary.terminated},
                      {"truncated", summary.truncated},
                      {"end_reason", summary.end_reason},
                      {"warnings", summary.warnings},
                      {"results", results},
                      {"tables", Tables()},
                      {"cameras", Cameras()},
                      {"metadata", metadata},
                      {"versions", Versions()},
                      {"models", models},
                      {"files", Files()},
                      {"run", run}};
  if (has_segmentation()) description["segmentation"] = Segmentation();
  if (!features.empty()) description["features"] = features;
  return InsertSelfHash(description.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

EpisodeWriter::EpisodeWriter(const fs::path& dataset, const std::string& id,
                             const EpisodeSchema& schema, const EpisodeOptions& options)
    : impl_(std::make_unique<Impl>()) {
  if (!IsEpisodeId(id)) {
    throw ArgumentError(
        fmt::format("'{}' cannot be an episode's id: it becomes the name of a visible folder", id));
  }
  impl_->id = id;
  impl_->name = fmt::format("episode '{}'", id);
  impl_->dataset = dataset;
  impl_->final = dataset / id;
  impl_->schema = schema;
  if (impl_->has_segmentation() && schema.segment_labels().empty()) {
    throw ArgumentError(impl_->name +
                        ": a camera has segmentation, so the schema needs labels of "
                        "what its numbers mean (SetSegmentLabels)");
  }
  impl_->metadata = ParseObject(impl_->name, "metadata_json", options.metadata_json);
  impl_->versions = ParseObject(impl_->name, "versions_json", options.versions_json);
  impl_->features = Json::parse(options.features.ToJson());
  impl_->Do("opening", [&] {
    const EpisodeLook there = LookAtEpisode(impl_->final);
    if (there.state == EpisodeState::kWhole)
      throw IoError(fmt::format("'{}' exists already", impl_->final.string()));
    if (there.state == EpisodeState::kBroken) throw IoError(there.problem);
    impl_->Open(options);
  });
}

EpisodeWriter::~EpisodeWriter() = default;
EpisodeWriter::EpisodeWriter(EpisodeWriter&&) noexcept = default;
EpisodeWriter& EpisodeWriter::operator=(EpisodeWriter&&) noexcept = default;

void EpisodeWriter::PutBytes(ColumnId column, ColumnType type, std::span<const std::byte> bytes) {
  impl_->Do("Put()", [&] { impl_->steps->Put(column, type, bytes); });
}

void EpisodeWriter::Put(ColumnId column, std::span<const double> values) {
  PutBytes(column, ColumnType::kFloat64, std::as_bytes(values));
}
void EpisodeWriter::Put(ColumnId column, std::span<const float> values) {
  PutBytes(column, ColumnType::kFloat32, std::as_bytes(values));
}
void EpisodeWriter::Put(ColumnId column, std::span<const int64_t> values) {
  PutBytes(column, ColumnType::kInt64, std::as_bytes(values));
}
void EpisodeWriter::Put(ColumnId column, std::span<const int32_t> values) {
  PutBytes(column, ColumnType::kInt32, std::as_bytes(values));
}
void EpisodeWriter::Put(ColumnId column, std::span<const uint8_t> values) {
  PutBytes(column, ColumnType::kUint8, std::as_bytes(values));
}
void EpisodeWriter::Put(ColumnId column, std::span<const bool> values) {
  PutBytes(column, ColumnType::kBool, std::as_bytes(values));
}

void EpisodeWriter::EndRow(TableId table) {
  impl_->Do("EndRow()", [&] { impl_->steps->EndRow(table); });
}

CameraFiles& EpisodeWriter::Impl::VideosOf(CameraId camera) {
  if (camera.index >= 0 && camera.index < static_cast<int>(videos.size()))
    return videos[camera.index];
  throw ArgumentError(fmt::format("{}: there is no camera number {}; it has {}", name, camera.index,
                                  videos.size()));
}

void EpisodeWriter::WriteFrame(CameraId camera, std::span<const uint8_t> rgb) {
  impl_->Do("WriteFrame()", [&] { impl_->VideosOf(camera).colour.Write(rgb); });
}

void EpisodeWriter::WriteDepth(CameraId camera, std::span<const uint16_t> millimetres) {
  impl_->Do("WriteDepth()", [&] {
    std::optional<VideoWriter>& video = impl_->VideosOf(camera).depth;
    if (!video) {
      throw ArgumentError(fmt::format("{}: camera '{}' was declared without depth", impl_->name,
                                      impl_->schema.cameras()[camera.index].stream.name));
    }
    video->Write(millimetres);
  });
}

void EpisodeWriter::Impl::RequireLabels(std::span<const uint16_t> labels) const {
  const size_t known = schema.segment_labels().size();
  const auto stray = std::find_if(labels.begin(), labels.end(), [&](uint16_t label) {
    return label >= known && label != kNoSegment;
  });
  if (stray == labels.end()) return;
  throw ArgumentError(
      fmt::format("{}: a pixel of segmentation is {}, of the {} labels 0 ... {}; "
                  "{} is for what has none",
                  name, *stray, known, known - 1, kNoSegment));
}

void EpisodeWriter::WriteSegmentation(CameraId camera, std::span<const uint16_t> labels) {
  impl_->Do("WriteSegmentation()", [&] {
    std::optional<VideoWriter>& video = impl_->VideosOf(camera).segmentation;
    if (!video) {
      throw ArgumentError(fmt::format("{}: camera '{}' was declared without segmentation",
                                      impl_->name,
                                      impl_->schema.cameras()[camera.index].stream.name));
    }
    impl_->RequireLabels(labels);
    video->Write(labels);
  });
}

void EpisodeWriter::AddFile(const std::string& name, std::string_view bytes) {
  impl_->Do("AddFile()", [&] {
    RequireFileName("file", name);
    if (name.starts_with('.') || name == kEpisodeFile || fs::exists(impl_->work->path() / name)) {
      throw ArgumentError(
          fmt::format("{}: '{}' cannot be added, the name is taken", impl_->name, name));
    }
    for (const CameraEntry& camera : impl_->schema.cameras()) {
      const std::string& stream = camera.stream.name;
      if (name == VideoFile(stream) || name == DepthFile(stream) ||
          name == SegmentationFile(stream)) {
        throw ArgumentError(
            fmt::format("{}: '{}' is the video of camera '{}'", impl_->name, name, stream));
      }
    }
    AtomicWrite(impl_->work->path() / name, bytes);
    impl_->extra_files.push_back(name);
  });
}

void EpisodeWriter::AddModel(const std::string& name, const FileSet& model) {
  impl_->Do("AddModel()", [&] {
    impl_->models[name] = StoredModelPath(model);
    impl_->model_files.push_back(model);
  });
}

fs::path EpisodeWriter::Commit(const EpisodeSummary& summary) {
  impl_->Do("Commit()", [&] {
    const Json results = ParseObject(impl_->name, "results_json", summary.results_json);
    const Json given = ParseObject(impl_->name, "run_json", summary.run_json);
    const Json run = impl_->Run(given);
    impl_->RequireFramesMatchRows();
    impl_->CloseFiles();
    AtomicWrite(impl_->work->path() / kEpisodeFile, impl_->Description(summary, results, run));
    // Now: an episode that is given up leaves no model behind.
    for (const FileSet& model : impl_->model_files) StoreModel(impl_->dataset, model);
    impl_->Rename();
    impl_->Remove();
  });
  return impl_->final;
}

void EpisodeWriter::Abort() noexcept {
  if (impl_->state == State::kOpen) impl_->state = State::kAborted;
  impl_->Remove();
}

int64_t EpisodeWriter::rows(TableId table) const {
  return impl_->steps ? impl_->steps->rows(table) : 0;
}
int64_t EpisodeWriter::frames(CameraId camera) const {
  return impl_->videos.empty() ? 0 : impl_->videos.at(camera.index).colour.frames();
}
int64_t EpisodeWriter::depth_frames(CameraId camera) const {
  if (impl_->videos.empty()) return 0;
  const std::optional<VideoWriter>& video = impl_->videos.at(camera.index).depth;
  return video ? video->frames() : 0;
}
int64_t EpisodeWriter::segmentation_frames(CameraId camera) const {
  if (impl_->videos.empty()) return 0;
  const std::optional<VideoWriter>& video = impl_->videos.at(camera.index).segmentation;
  return video ? video->frames() : 0;
}
const std::string& EpisodeWriter::id() const { return impl_->id; }
bool EpisodeWriter::is_open() const { return impl_->state == State::kOpen; }

}  // namespace robocell
