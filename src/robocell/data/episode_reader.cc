#include "robocell/data/episode_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <mutex>
#include <numeric>
#include <optional>
#include <type_traits>
#include <nlohmann/json.hpp>

#include "robocell/base/checked_json.h"
#include "robocell/base/error.h"
#include "robocell/base/idle_pool.h"
#include "robocell/base/packed_index.h"
#include "robocell/base/paths.h"
#include "robocell/base/stored_file.h"
#include "robocell/base/suggestions.h"
#include "robocell/data/episode_files.h"
#include "robocell/data/hdf5.h"
#include "robocell/data/model_store.h"
#include "robocell/media/frame_pool.h"
#include "robocell/media/warm_program.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// Returns the file of a further kind of images; "" if the camera has none.
std::string FileOfKind(const Json& camera, const char* kind) {
  return camera.contains(kind) ? camera[kind].at("file").get<std::string>() : "";
}

CameraInfo ReadCamera(const std::string& name, const Json& json) {
  return {.name = name,
          .file = json.at("file"),
          .depth_file = FileOfKind(json, "depth"),
          .segmentation_file = FileOfKind(json, "segmentation"),
          .table = json.at("table"),
          .frames = JsonCount<int64_t>(json.at("frames")),
          .width = JsonCount<int>(json.at("width")),
          .height = JsonCount<int>(json.at("height")),
          .fps_num = JsonCount<int>(json.at("fps").at(0)),
          .fps_den = JsonCount<int>(json.at("fps").at(1))};
}

std::vector<SegmentLabel> ReadLabels(const Json& episode) {
  std::vector<SegmentLabel> labels;
  if (!episode.contains("segmentation")) return labels;
  for (const Json& label : episode["segmentation"].at("labels"))
    labels.push_back({.name = label.at("name"), .owner = label.at("owner")});
  return labels;
}

ColumnInfo ReadColumn(const internal::hdf5::File& file, const std::string& name) {
  const internal::hdf5::H5Dataset dataset = file.Open(name);
  ColumnInfo info;
  info.spec = {.name = name,
               .type = dataset.type(),
               .shape = dataset.shape(),
               .units = dataset.Text("units"),
               .frame = dataset.Text("frame"),
               .names = dataset.Texts("names"),
               .values = dataset.Texts("values"),
               .description = dataset.Text("description")};
  info.table = dataset.Text("table");
  if (!info.table.empty() && !info.spec.shape.empty()) {
    info.rows = info.spec.shape.front();
    info.spec.shape.erase(info.spec.shape.begin());
  }
  return info;
}

template <typename Info>
std::vector<std::string> Names(const std::vector<Info>& infos) {
  std::vector<std::string> names;
  for (const Info& info : infos) {
    if constexpr (std::is_same_v<Info, ColumnInfo>) {
      names.push_back(info.spec.name);
    } else {
      names.push_back(info.name);
    }
  }
  return names;
}

// steps.h5 of an episode, open between calls.
struct OpenSteps {
  std::filesystem::path path;
  std::string identity;  // identity of the file
  std::string sha256;    // hash that it was compared with, or just written with
  internal::hdf5::File file;
};

internal::hdf5::File OpenStored(const fs::path& path) {
  const auto part = PartAt(path);
  if (!part) return internal::hdf5::File::OpenReadOnly(path);
  return internal::hdf5::File::OpenBytes(internal::ReadStoredFile(path, part->bytes), path);
}

// Open files cost memory and descriptors; opening one takes at least a tenth of a millisecond.
internal::IdlePool<OpenSteps>& StepsPool() {
  static internal::IdlePool<OpenSteps> pool(32);
  return pool;
}

// Returns, for each time, the index of the last row of a table at that time or before.
std::vector<int64_t> LastNotNewer(const std::vector<double>& of, const std::vector<double>& in) {
  constexpr double kSame_s = 1e-6;
  std::vector<int64_t> last;
  for (const double time : of) {
    const auto after = std::upper_bound(in.begin(), in.end(), time + kSame_s);
    last.push_back(after - in.begin() - 1);
  }
  return last;
}

}  // namespace

std::string_view NameOf(ImageKind kind) {
  switch (kind) {
    case ImageKind::kColour:
      return "rgb";
    case ImageKind::kDepth:
      return "depth";
    default:
      return "segmentation";
  }
}

void ReleaseIdleFiles() {
  StepsPool().Clear();
  internal::FramePool::Shared().Clear();
  internal::EndWarmPrograms();
}

struct Episode::Impl {
  fs::path folder;
  StepsBytes steps_bytes = StepsBytes::kCompare;
  std::string text;
  Json json;
  std::string id;
  std::string end_reason;
  std::vector<std::string> warnings;
  std::vector<CameraInfo> cameras;
  std::vector<SegmentLabel> labels;
  FeatureSchema features;

  mutable std::once_flag listed;
  mutable std::vector<ColumnInfo> columns;
  mutable std::mutex compared_mutex;
  mutable std::string compared;  // identity of the steps.h5 that was last compared

  std::string Name() const { return fmt::format("episode '{}'", folder.string()); }

  void Parse() {
    try {
      json = Json::parse(text);
      if (json.at("format") != kEpisodeFormat)
        throw IoError(Name() + ": episode.json is of another format");
      const int version = JsonCount<int>(json.at("format_version"));
      if (version != kEpisodeFormatVersion) {
        throw IoError(fmt::format("{}: format version {} is not {}, which this robocell reads",
                                  Name(), version, kEpisodeFormatVersion));
      }
      if (JsonDamage(text)) ThrowDamaged();
      id = json.at("id");
      end_reason = json.at("end_reason");
      warnings = json.at("warnings").get<std::vector<std::string>>();
      for (const auto& [name, camera] : json.at("cameras").items())
        cameras.push_back(ReadCamera(name, camera));
      labels = ReadLabels(json);
      // The number of unlabelled pixels is the same in every episode.
      if (json.contains("segmentation") && json["segmentation"].at("none") != kNoSegment)
        ThrowDamaged();
      for (const char* key : {"success", "terminated", "truncated", "metadata", "results", "tables",
                              "versions", "run"}) {
        json.at(key);  // read later without a check
      }
      for (const auto& [name, table] : json["tables"].items()) JsonCount<int64_t>(table.at("rows"));
      if (json.contains("features")) features = FeatureSchema::FromJson(json["features"].dump());
      RequireFiles();
      RequireModels();
    } catch (const nlohmann::json::exception&) {
      ThrowDamaged();
    } catch (const SpecError& error) {  // invalid features
      throw IoError(fmt::format("{}: episode.json: {}", Name(), error.what()));
    }
  }

  // Leaves out the parser's own words.
  [[noreturn]] void ThrowDamaged() const {
    const std::string damage =
        JsonDamage(text).value_or("its hash is right, but it does not describe an episode");
    throw IoError(fmt::format("{}: episode.json is damaged: {}{}", Name(), damage, Advice()));
  }

  std::string Advice() const {
    const std::string dataset = internal::ShellWord(folder.parent_path().string());
    if (internal::IsPacked(folder.parent_path())) {
      return fmt::format(
          ". `robocell verify {}` names all that is damaged, `robocell unpack --skip-damaged {} "
          "OUT` keeps the rest",
          dataset, dataset);
    }
    return fmt::format(
        ". `robocell verify {}` names all that is damaged, `robocell verify "
        "--repair {}` sets it aside",
        dataset, dataset);
  }

  void RequireFiles() const {
    for (const auto& [file, facts] : json.at("files").items()) {
      if (!internal::ValidFileName(file))
        throw IoError(fmt::format("{}: episode.json lists a file '{}'", Name(), file));
      const std::string what = internal::WhatIsStoredAt(folder / file);
      if (what != "nothing" && !internal::CanReadStoredFile(folder / file))
        throw IoError(fmt::format("{}: '{}' is {}, not a file{}", Name(), file, what, Advice()));
      const uint64_t size = SizeOf(file);
      const auto written = JsonCount<uint64_t>(facts.at("bytes"));
      if (size == written) continue;
      throw IoError(fmt::format("{}: '{}' has {} bytes, expected {}{}", Name(), file, size, written,
                                Advice()));
    }
  }

  uint64_t SizeOf(const std::string& file) const try {
    return internal::StoredFileBytes(folder / file);
  } catch (const IoError& error) {
    throw IoError(
        fmt::format("{}: '{}': {}{}", Name(), file, std::strerror(error.system_error()), Advice()));
  }

  void RequireModels() const {
    const auto models = json.find("models");
    if (models == json.end()) return;
    for (const auto& [name, path] : models->items()) {
      if (!internal::IsStoredModelPath(path.get<std::string>()))
        throw IoError(
            fmt::format("{}: episode.json keeps model '{}' at {}", Name(), name, path.dump()));
    }
  }

  // Returns the path of a file directly in the folder.
  fs::path FileOf(const std::string& name) const {
    if (!internal::ValidFileName(name))
      throw IoError(fmt::format(
          "{}: episode.json names a file '{}', which is not one of its folder", Name(), name));
    return internal::RequireStoredFile(folder / name);
  }

  fs::path VideoOf(const CameraInfo& camera, ImageKind kind) const {
    if (kind == ImageKind::kColour) return FileOf(camera.file);
    std::string CameraInfo::*file =
        kind == ImageKind::kDepth ? &CameraInfo::depth_file : &CameraInfo::segmentation_file;
    if (!(camera.*file).empty()) return FileOf(camera.*file);
    std::vector<std::string> others;
    for (const CameraInfo& each : cameras) {
      if (!(each.*file).empty()) others.push_back(each.name);
    }
    throw NotFoundError(fmt::format("{}: camera '{}' has no {}. Cameras with {}: {}", Name(),
                                    camera.name, NameOf(kind), NameOf(kind),
                                    others.empty() ? "none" : ListNames(others)));
  }

  template <typename Pixel>
  void ReadFrame(const CameraInfo& camera, ImageKind kind, int64_t index,
                 std::span<Pixel> pixels) const {
    const fs::path video = VideoOf(camera, kind);
    if (index < 0 || index >= camera.frames) {
      throw ArgumentError(fmt::format(
          "{}: no frame {} of '{}'. It has {}: {}", Name(), index, camera.name,
          Counted(camera.frames, "frame"),
          camera.frames > 1 ? fmt::format("0 ... {}", camera.frames - 1) : std::string("0")));
    }
    internal::FramePool::Shared().Read(video, index, pixels);
  }

  // The HDF5 library ends the process on some files with a single flipped bit.
  void RequireUndamagedSteps() const {
    const std::string name(kStepsFile), written = WrittenHash();
    if (!written.empty() && written == internal::Sha256StoredFile(folder / name)) return;
    throw IoError(
        fmt::format("{}: '{}' is damaged: its hash does not match{}", Name(), name, Advice()));
  }

  std::string WrittenHash() const {
    const auto& files = json["files"];
    const auto facts = files.find(std::string(kStepsFile));
    return facts == files.end() ? "" : facts->value("sha256", std::string());
  }

  // Compares once for each content of the file: opening it again later is cheap.
  void CompareOnce(const std::string& identity) const {
    const std::lock_guard lock(compared_mutex);
    if (compared == identity) return;
    if (steps_bytes == StepsBytes::kCompare) RequireUndamagedSteps();
    compared = identity;
  }

  // Opens the file on first use: lists of episodes need episode.json only.
  template <typename Use>
  void WithSteps(const Use& use) const {
    const fs::path path = internal::RequireStoredFile(folder / kStepsFile);
    const std::string identity = internal::StoredFileIdentity(path), hash = WrittenHash();
    const auto same_path = [&](const OpenSteps& open) { return open.path == path; };
    auto steps = StepsPool().Take(same_path);
    // A file that was overwritten is closed before it is opened anew: HDF5 treats a file that it
    // has open as unchanged, whatever its content is now.
    while (steps && (steps->identity != identity || steps->sha256 != hash)) {
      steps.reset();
      steps = StepsPool().Take(same_path);
    }
    if (!steps) {
      CompareOnce(identity);
      steps.emplace(OpenSteps{path, identity, hash, OpenStored(path)});
    }
    use(steps->file);
    StepsPool().Give(std::move(*steps));
  }

  const std::vector<ColumnInfo>& Columns() const {
    std::call_once(listed, [&] {
      WithSteps([&](const internal::hdf5::File& file) {
        std::vector<ColumnInfo> found;
        for (const std::string& name : file.DatasetNames()) found.push_back(ReadColumn(file, name));
        columns = std::move(found);
      });
    });
    return columns;
  }

  // Returns the rows to read; throws ArgumentError if some do not exist.
  std::pair<int64_t, int64_t> Rows(const ColumnInfo& info, const RowRange& range) const {
    const int64_t count = range.count.value_or(info.rows - range.first);
    if (range.first >= 0 && count >= 0 && count <= info.rows - range.first)
      return {range.first, count};
    throw ArgumentError(fmt::format("{}: rows {} ... {} of '{}' were requested, it has {}", Name(),
                                    range.first, range.first + count - 1, info.spec.name,
                                    info.rows));
  }
};

Episode::Episode(const fs::path& folder, StepsBytes steps) : impl_(std::make_unique<Impl>()) {
  impl_->folder = folder;
  impl_->steps_bytes = steps;
  impl_->text = internal::ReadStoredFile(folder / kEpisodeFile);
  impl_->Parse();
}

Episode::~Episode() = default;
Episode::Episode(Episode&&) noexcept = default;
Episode& Episode::operator=(Episode&&) noexcept = default;

const fs::path& Episode::folder() const { return impl_->folder; }
const std::string& Episode::id() const { return impl_->id; }
bool Episode::success() const { return impl_->json["success"] == true; }
bool Episode::terminated() const { return impl_->json["terminated"] == true; }
bool Episode::truncated() const { return impl_->json["truncated"] == true; }
const std::string& Episode::end_reason() const { return impl_->end_reason; }
const std::vector<std::string>& Episode::warnings() const { return impl_->warnings; }
const std::string& Episode::json() const { return impl_->text; }
std::string Episode::metadata_json() const { return impl_->json["metadata"].dump(2); }
std::string Episode::results_json() const { return impl_->json["results"].dump(2); }
std::string Episode::versions_json() const { return impl_->json["versions"].dump(2); }
const FeatureSchema& Episode::features() const { return impl_->features; }
std::string Episode::run_json() const { return impl_->json["run"].dump(2); }

std::vector<std::string> Episode::tables() const {
  std::vector<std::string> names;
  for (const auto& [name, table] : impl_->json["tables"].items()) names.push_back(name);
  return names;
}

int64_t Episode::rows(const std::string& table) const {
  const Json& all = impl_->json["tables"];
  if (const auto found = all.find(table); found != all.end())
    return found->value("rows", int64_t{0});
  throw NotFoundError(NoSuchName(impl_->Name(), "table", table, tables()));
}

std::vector<std::string> Episode::files() const {
  std::vector<std::string> names;
  for (const auto& [name, facts] : impl_->json["files"].items()) names.push_back(name);
  return names;
}

std::map<std::string, std::string> Episode::models() const {
  const auto found = impl_->json.find("models");
  if (found == impl_->json.end()) return {};
  std::map<std::string, std::string> models;
  for (const auto& [name, path] : found->items()) models[name] = path;
  return models;
}

const std::vector<ColumnInfo>& Episode::columns() const { return impl_->Columns(); }

const ColumnInfo& Episode::column(const std::string& name) const {
  for (const ColumnInfo& info : columns()) {
    if (info.spec.name == name) return info;
  }
  throw NotFoundError(NoSuchName(impl_->Name(), "column", name, Names(columns())));
}

size_t Episode::ValueCount(const std::string& name, const RowRange& range) const {
  const ColumnInfo& info = column(name);
  const int64_t rows = info.table.empty() ? 1 : impl_->Rows(info, range).second;
  return static_cast<size_t>(rows * RowValues(info.spec.shape));
}

void Episode::ReadBytes(const std::string& name, const RowRange& range, ColumnType type,
                        std::span<std::byte> bytes) const {
  const ColumnInfo& info = column(name);
  const bool bool_as_byte = type == ColumnType::kUint8 && info.spec.type == ColumnType::kBool;
  if (type != info.spec.type && !bool_as_byte) {
    throw ArgumentError(fmt::format("{}: column '{}' holds {}, it cannot be read as {}",
                                    impl_->Name(), name, NameOf(info.spec.type), NameOf(type)));
  }
  const size_t needed = ValueCount(name, range) * SizeOf(type);
  if (bytes.size() != needed) {
    throw ArgumentError(
        fmt::format("{}: '{}' needs {} bytes, got {}", impl_->Name(), name, needed, bytes.size()));
  }
  impl_->WithSteps([&](const internal::hdf5::File& file) {
    const internal::hdf5::H5Dataset dataset = file.Open(name);
    if (info.table.empty()) return dataset.ReadAll(bytes);
    const auto [first, count] = impl_->Rows(info, range);
    dataset.ReadRows(first, count, bytes);
  });
}

const std::vector<CameraInfo>& Episode::cameras() const { return impl_->cameras; }

const CameraInfo& Episode::camera(const std::string& name) const {
  for (const CameraInfo& info : cameras()) {
    if (info.name == name) return info;
  }
  throw NotFoundError(NoSuchName(impl_->Name(), "camera", name, Names(cameras())));
}

VideoReader Episode::Video(const std::string& name) const {
  return VideoReader(impl_->VideoOf(camera(name), ImageKind::kColour));
}

VideoReader Episode::DepthVideo(const std::string& name) const {
  return VideoReader(impl_->VideoOf(camera(name), ImageKind::kDepth));
}

VideoReader Episode::SegmentationVideo(const std::string& name) const {
  return VideoReader(impl_->VideoOf(camera(name), ImageKind::kSegmentation));
}

std::vector<ImageStream> Episode::streams() const {
  std::vector<ImageStream> found;
  for (const CameraInfo& info : cameras()) {
    const auto add = [&](ImageKind kind, const std::string& ending) {
      found.push_back({.name = info.name + ending, .camera = info.name, .kind = kind});
    };
    add(ImageKind::kColour, "");
    if (!info.depth_file.empty()) add(ImageKind::kDepth, ".depth");
    if (!info.segmentation_file.empty()) add(ImageKind::kSegmentation, ".segmentation");
  }
  return found;
}

ImageStream Episode::stream(const std::string& name) const {
  const std::vector<ImageStream> all = streams();
  std::vector<std::string> names;
  for (const ImageStream& each : all) {
    if (each.name == name) return each;
    names.push_back(each.name);
  }
  throw NotFoundError(NoSuchName(impl_->Name(), "image stream", name, names));
}

void Episode::ReadFrame(const std::string& name, ImageKind kind, int64_t index,
                        std::span<uint8_t> rgb) const {
  impl_->ReadFrame(camera(name), kind, index, rgb);
}

void Episode::ReadFrame(const std::string& name, ImageKind kind, int64_t index,
                        std::span<uint16_t> pixels) const {
  impl_->ReadFrame(camera(name), kind, index, pixels);
}

std::vector<int64_t> Episode::FramesOfRows(const std::string& name,
                                           const std::string& table) const {
  const CameraInfo& info = camera(name);
  if (info.table == table) {
    std::vector<int64_t> same(static_cast<size_t>(rows(table)));
    std::iota(same.begin(), same.end(), int64_t{0});
    return same;
  }
  rows(table);  // throws NotFoundError
  const auto times = [&](const std::string& of) {
    const std::string time = of == "steps" ? "time" : of + "/time";
    for (const ColumnInfo& column : columns()) {
      if (column.spec.name == time) return Read<double>(time);
    }
    throw ArgumentError(fmt::format(
        "{}: the frames of '{}' belong to the rows of table '{}', and which of them are "
        "of the rows of '{}' is not known without a column '{}'",
        impl_->Name(), name, info.table, table, time));
  };
  return LastNotNewer(times(table), times(info.table));
}

const std::vector<SegmentLabel>& Episode::segment_labels() const { return impl_->labels; }

}  // namespace robocell
