#include "robocell/data/episode_writer.h"

#include <unistd.h>
#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <numeric>
#include <optional>
#include <system_error>
#include <type_traits>
#include <utility>
#include <nlohmann/json.hpp>

#include "robocell/base/error.h"
#include "robocell/base/forks.h"
#include "robocell/base/io_error.h"
#include "robocell/base/packed_index.h"
#include "robocell/base/paths.h"
#include "robocell/base/suggestions.h"
#include "robocell/data/episode_commit.h"
#include "robocell/data/episode_files.h"
#include "robocell/data/episode_state.h"
#include "robocell/data/model_store.h"
#include "robocell/data/steps_file.h"
#include "robocell/data/work_folder.h"
#include "robocell/media/video_info.h"
#include "robocell/media/video_writer.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// The videos of one camera.
struct CameraFiles {
  std::optional<VideoWriter> colour;  // unset if a finished video was added
  int64_t added_frames = 0;           // of the finished video
  std::optional<VideoWriter> depth = {};
  std::optional<VideoWriter> segmentation = {};

  int64_t frames() const { return colour ? colour->frames() : added_frames; }
};

// Copies a file with the permissions of a new one, whatever those of the source are.
void CopyContent(const fs::path& source, const fs::path& copy) {
  std::ofstream(copy).close();
  const fs::perms permissions = fs::status(copy).permissions();
  fs::copy_file(source, copy, fs::copy_options::overwrite_existing);
  fs::permissions(copy, permissions);
}

// Throws ArgumentError unless a video has the size and rate of a camera.
void RequireVideoOf(const CameraStream& camera, const std::string& where, const VideoInfo& info) {
  const int divisor = std::gcd(camera.fps_num, camera.fps_den);
  const bool has_rate = info.constant_rate && info.fps_num == camera.fps_num / divisor &&
                        info.fps_den == camera.fps_den / divisor;
  if (info.kind == VideoKind::kColour && info.width == camera.width &&
      info.height == camera.height && has_rate)
    return;
  throw ArgumentError(
      fmt::format("{} is {} of {}x{} px at {}/{} fps{}; the camera was declared with colour, {}x{} "
                  "px and {}/{}",
                  where, info.kind == VideoKind::kColour ? "a video" : "a 16-bit video", info.width,
                  info.height, info.fps_num, info.fps_den, info.constant_rate ? "" : " on average",
                  camera.width, camera.height, camera.fps_num, camera.fps_den));
}

enum class State { kOpen, kFailed, kCommitted, kAborted };

}  // namespace

bool IsEpisodeId(std::string_view id) {
  const bool is_of_dataset = id == kModelsFolder || id == kManifestFile || IsReportFile(id);
  return internal::ValidFileName(id) && !id.starts_with('.') && !is_of_dataset;
}

struct EpisodeWriter::Impl {
  fs::path dataset;
  fs::path final;
  std::unique_ptr<internal::WorkFolder> work;
  std::string id;
  std::string name;  // name for messages
  std::string started = internal::UtcNow();
  EpisodeSchema schema;
  Json metadata;
  Json features;  // the meaning of the columns
  Json versions;
  std::unique_ptr<internal::StepsFile> steps;
  // Indexed by camera.
  std::unique_ptr<std::vector<CameraFiles>> owned_videos =
      std::make_unique<std::vector<CameraFiles>>();
  std::vector<CameraFiles>& videos = *owned_videos;
  std::vector<std::string> extra_files;
  Json models = Json::object();
  std::vector<FileSet> model_files;  // files by the metadata's names
  State state = State::kOpen;
  pid_t owner = getpid();
  int forks =
      internal::ForkCount();  // at the beginning: asking the system in every call takes long
  std::string failure;

  ~Impl() { internal::ForkCount() == forks ? Remove() : Abandon(); }

  // Called in a fork of the process that began the episode: files and folders belong to the other
  // process, which still writes. Closing them here would write and remove.
  void Abandon() noexcept {
    (void)steps.release();
    (void)work.release();
    (void)owned_videos.release();
  }

  void Remove() noexcept {
    steps.reset();
    videos.clear();
    work.reset();
  }

  // Runs an action of the open episode; a failure ends the episode for good.
  template <typename Action>
  void Do(const char* call, Action action) {
    if (state == State::kFailed) throw IoError(failure);
    if (internal::ForkCount() != forks) {
      throw ClosedError(
          fmt::format("{}: {} in a fork of process {}, which is still writing it; begin an episode "
                      "after the fork",
                      name, call, owner));
    }
    if (state != State::kOpen) {
      throw ClosedError(fmt::format("{}: {} after it was {}", name, call,
                                    state == State::kCommitted ? "committed" : "aborted"));
    }
    try {
      action();
    } catch (const ArgumentError&) {
      throw;  // the caller's mistake: nothing was changed
    } catch (const EncoderDied& error) {
      FailAs<EncoderDied>(error.what());
    } catch (const std::exception& error) {
      if (state == State::kCommitted) throw IoError(fmt::format("{}: {}", name, error.what()));
      FailAs<IoError>(error.what());
    }
  }

  template <class Kind>
  [[noreturn]] void FailAs(const std::string& reason) {
    state = State::kFailed;
    // Whoever made the episode can make it again after a killed encoder.
    const char* end = std::is_same_v<Kind, EncoderDied> ? "" : " is not saved";
    failure = fmt::format("{}{}: {}", name, end, WithSpaceHint(reason, dataset, BytesWritten()));
    Remove();
    throw Kind(failure);
  }

  // Returns the bytes on the disk so far.
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
  void RequireOnePerRow(const CameraEntry& camera, const char* what, int64_t frames) const;
  CameraFiles& VideosOf(CameraId camera);
  std::string CameraName(CameraId camera) const;
  void CloseFiles();
  internal::EpisodeContent Content() const;
};

void EpisodeWriter::Impl::Open(const EpisodeOptions& options) {
  work = std::make_unique<internal::WorkFolder>(dataset, id);
  steps = std::make_unique<internal::StepsFile>(work->path() / kStepsFile, name, schema);
  for (const CameraEntry& camera : schema.cameras()) {
    const CameraStream& stream = camera.stream;
    VideoOptions video{.width = stream.width,
                       .height = stream.height,
                       .fps_num = stream.fps_num,
                       .fps_den = stream.fps_den,
                       .preset = options.video_preset,
                       .crf = options.video_crf,
                       .keyframe_interval = options.video_keyframe_interval};
    videos.emplace_back();
    videos.back().colour.emplace(work->path() / VideoFile(stream.name), video);
    video.kind = VideoKind::kGray16;
    if (stream.depth) videos.back().depth.emplace(work->path() / DepthFile(stream.name), video);
    if (stream.segmentation)
      videos.back().segmentation.emplace(work->path() / SegmentationFile(stream.name), video);
  }
}

void EpisodeWriter::Impl::RequireFramesMatchRows() const {
  if (steps->rows(kStepsTable) == 0) throw ArgumentError(fmt::format("{}: it has no row", name));
  for (size_t i = 0; i < videos.size(); ++i) {
    const CameraEntry& camera = schema.cameras()[i];
    RequireOnePerRow(camera, "frame", videos[i].frames());
    if (videos[i].depth) RequireOnePerRow(camera, "depth frame", videos[i].depth->frames());
    if (videos[i].segmentation)
      RequireOnePerRow(camera, "segmentation frame", videos[i].segmentation->frames());
  }
}

void EpisodeWriter::Impl::RequireOnePerRow(const CameraEntry& camera, const char* what,
                                           int64_t frames) const {
  const int64_t rows = steps->rows(camera.table);
  if (frames == rows) return;
  throw ArgumentError(
      fmt::format("{}: camera '{}' has {} for the {} of table '{}'; each row needs one", name,
                  camera.stream.name, Counted(frames, what), Counted(rows, "row"),
                  schema.tables()[camera.table.index].name));
}

void EpisodeWriter::Impl::CloseFiles() {
  steps->Close();
  for (CameraFiles& camera : videos) {
    if (camera.colour) camera.colour->Finish();
    if (camera.depth) camera.depth->Finish();
    if (camera.segmentation) camera.segmentation->Finish();
  }
  steps->VerifyContent();
}

internal::EpisodeContent EpisodeWriter::Impl::Content() const {
  internal::EpisodeContent content{.id = id,
                                   .name = name,
                                   .folder = work->path(),
                                   .schema = schema,
                                   .metadata = metadata,
                                   .features = features,
                                   .versions = versions,
                                   .models = models,
                                   .extra_files = extra_files};
  for (size_t i = 0; i < schema.tables().size(); ++i)
    content.rows.push_back(steps->rows({static_cast<int>(i)}));
  for (const CameraFiles& camera : videos) {
    content.frames.push_back({camera.frames(), camera.depth ? camera.depth->frames() : 0,
                              camera.segmentation ? camera.segmentation->frames() : 0});
  }
  return content;
}

EpisodeWriter::EpisodeWriter(const fs::path& dataset, const std::string& id,
                             const EpisodeSchema& schema, const EpisodeOptions& options)
    : impl_(std::make_unique<Impl>()) {
  if (!IsEpisodeId(id)) {
    throw ArgumentError(
        fmt::format("'{}' cannot be an episode's id: it becomes the name of a visible folder, and "
                    "models, dataset.json and report.json are the dataset's own",
                    id));
  }
  internal::RequireNotPacked(dataset, "write an episode");
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
  impl_->metadata = internal::ParseObject(impl_->name, "metadata_json", options.metadata_json);
  impl_->versions = internal::ParseObject(impl_->name, "versions_json", options.versions_json);
  impl_->features = Json::parse(options.features.ToJson());
  impl_->Do("opening", [&] {
    const internal::EpisodeLook there = internal::LookAtEpisode(impl_->final);
    if (there.state == internal::EpisodeState::kWhole)
      throw IoError(fmt::format("'{}' exists already", impl_->final.string()));
    if (there.state == internal::EpisodeState::kBroken) throw IoError(there.problem);
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

std::string EpisodeWriter::Impl::CameraName(CameraId camera) const {
  return fmt::format("{}: camera '{}'", name, schema.cameras()[camera.index].stream.name);
}

CameraFiles& EpisodeWriter::Impl::VideosOf(CameraId camera) {
  if (camera.index >= 0 && camera.index < static_cast<int>(videos.size()))
    return videos[camera.index];
  throw ArgumentError(fmt::format("{}: there is no camera number {}; it has {}", name, camera.index,
                                  videos.size()));
}

void EpisodeWriter::WriteFrame(CameraId camera, std::span<const uint8_t> rgb) {
  impl_->Do("WriteFrame()", [&] {
    std::optional<VideoWriter>& video = impl_->VideosOf(camera).colour;
    if (!video) throw ArgumentError(impl_->CameraName(camera) + " has a video already");
    video->Write(rgb);
  });
}

void EpisodeWriter::AddVideo(CameraId camera, const fs::path& video) {
  impl_->Do("AddVideo()", [&] {
    CameraFiles& files = impl_->VideosOf(camera);
    const std::string name = impl_->CameraName(camera);
    if (!files.colour || files.frames() > 0)
      throw ArgumentError(name + " has frames already; it takes one video, or single frames");
    const CameraStream& stream = impl_->schema.cameras()[camera.index].stream;
    VideoInfo info;
    try {
      info = ReadVideoInfo(video);
    } catch (const IoError& error) {
      throw ArgumentError(fmt::format("{}: {}", name, error.what()));  // the caller's file
    }
    RequireVideoOf(stream, fmt::format("{}: '{}'", name, video.string()), info);
    files.colour.reset();
    CopyContent(video, impl_->work->path() / VideoFile(stream.name));
    files.added_frames = info.frames;
  });
}

void EpisodeWriter::WriteDepth(CameraId camera, std::span<const uint16_t> millimetres) {
  impl_->Do("WriteDepth()", [&] {
    std::optional<VideoWriter>& video = impl_->VideosOf(camera).depth;
    if (!video) {
      throw ArgumentError(impl_->CameraName(camera) + " was declared without depth");
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
      throw ArgumentError(impl_->CameraName(camera) + " was declared without segmentation");
    }
    impl_->RequireLabels(labels);
    video->Write(labels);
  });
}

void EpisodeWriter::AddFile(const std::string& name, std::string_view bytes) {
  impl_->Do("AddFile()", [&] {
    internal::RequireFileName("file", name);
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
    internal::WriteNewFile(impl_->work->path() / name, bytes);
    impl_->extra_files.push_back(name);
  });
}

void EpisodeWriter::AddModel(const std::string& name, const FileSet& model) {
  impl_->Do("AddModel()", [&] {
    impl_->models[name] = internal::StoredModelPath(model);
    impl_->model_files.push_back(model);
  });
}

fs::path EpisodeWriter::Commit(const EpisodeSummary& summary) {
  impl_->Do("Commit()", [&] {
    const internal::EpisodeResults results(impl_->name, impl_->started, summary);
    impl_->RequireFramesMatchRows();
    impl_->CloseFiles();
    internal::DescribeEpisode(impl_->Content(), summary, results);
    // Stored only now, so that an abandoned episode leaves no model behind.
    for (const FileSet& model : impl_->model_files) internal::StoreModel(impl_->dataset, model);
    try {
      internal::PutInPlace(*impl_->work, impl_->final);
    } catch (...) {
      // From the rename on the episode exists, whatever happens.
      if (impl_->work->committed()) impl_->state = State::kCommitted;
      throw;
    }
    impl_->state = State::kCommitted;
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
  return impl_->videos.empty() ? 0 : impl_->videos.at(camera.index).frames();
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
