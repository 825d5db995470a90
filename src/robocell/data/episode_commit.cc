#include "robocell/data/episode_commit.h"

#include <fcntl.h>
#include <unistd.h>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <cerrno>
#include <chrono>
#include <ctime>

#include "robocell/base/checked_json.h"
#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/hash.h"
#include "robocell/base/host.h"
#include "robocell/base/io_error.h"
#include "robocell/base/version.h"
#include "robocell/data/episode_files.h"
#include "robocell/data/hdf5.h"
#include "robocell/media/ffmpeg.h"
#include "robocell/media/video_info.h"

namespace robocell::internal {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

Json TablesOf(const EpisodeContent& content) {
  Json tables = Json::object();
  for (size_t i = 0; i < content.rows.size(); ++i)
    tables[content.schema.tables()[i].name] = {{"rows", content.rows[i]}};
  return tables;
}

Json CamerasOf(const EpisodeContent& content) {
  Json cameras = Json::object();
  for (size_t i = 0; i < content.frames.size(); ++i) {
    const CameraEntry& camera = content.schema.cameras()[i];
    const CameraStream& stream = camera.stream;
    cameras[stream.name] = {{"file", VideoFile(stream.name)},
                            {"table", content.schema.tables()[camera.table.index].name},
                            {"frames", content.frames[i].colour},
                            {"width", stream.width},
                            {"height", stream.height},
                            {"fps", {stream.fps_num, stream.fps_den}}};
    if (stream.depth) {
      cameras[stream.name]["depth"] = {
          {"file", DepthFile(stream.name)}, {"frames", content.frames[i].depth}, {"units", "mm"}};
    }
    if (stream.segmentation) {
      cameras[stream.name]["segmentation"] = {{"file", SegmentationFile(stream.name)},
                                              {"frames", content.frames[i].segmentation}};
    }
  }
  return cameras;
}

// Returns the labels of 0, 1, ...
Json LabelsOf(const EpisodeSchema& schema) {
  Json labels = Json::array();
  for (const SegmentLabel& label : schema.segment_labels())
    labels.push_back({{"name", label.name}, {"owner", label.owner}});
  return {{"none", kNoSegment}, {"labels", labels}};
}

bool HasSegmentation(const EpisodeSchema& schema) {
  for (const CameraEntry& camera : schema.cameras()) {
    if (camera.stream.segmentation) return true;
  }
  return false;
}

Json FilesOf(const EpisodeContent& content) {
  std::vector<std::string> names = {std::string(kStepsFile)};
  for (const CameraEntry& camera : content.schema.cameras()) {
    names.push_back(VideoFile(camera.stream.name));
    if (camera.stream.depth) names.push_back(DepthFile(camera.stream.name));
    if (camera.stream.segmentation) names.push_back(SegmentationFile(camera.stream.name));
  }
  names.insert(names.end(), content.extra_files.begin(), content.extra_files.end());
  Json files = Json::object();
  for (const std::string& file : names) {
    files[file] = {{"bytes", fs::file_size(content.folder / file)},
                   {"sha256", Sha256File(content.folder / file)}};
  }
  return files;
}

Json VersionsOf(const EpisodeContent& content) {
  Json all = {{"robocell", std::string(Version())}, {"hdf5", hdf5::Version()}};
  if (!content.frames.empty()) {
    const std::string video = VideoFile(content.schema.cameras()[0].stream.name);
    all["ffmpeg"] = FfmpegVersion();
    all["encoder"] = ReadVideoInfo(content.folder / video).encoder;
  }
  all.update(content.versions);
  return all;
}

}  // namespace

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

std::string UtcNow() {
  const auto now = std::chrono::system_clock::now();
  const auto seconds = std::chrono::floor<std::chrono::seconds>(now);
  const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(now - seconds).count();
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z",
                     fmt::gmtime(std::chrono::system_clock::to_time_t(seconds)), ms);
}

EpisodeResults::EpisodeResults(const std::string& name, const std::string& started,
                               const EpisodeSummary& summary)
    : results(ParseObject(name, "results_json", summary.results_json)),
      run({{"host", HostName()},
           {"process", ::getpid()},
           {"started", started},
           {"finished", UtcNow()}}) {
  const Json given = ParseObject(name, "run_json", summary.run_json);
  for (const auto& [key, value] : given.items()) {
    if (run.contains(key) || key == kJsonHash) {
      throw ArgumentError(
          fmt::format("{}: run_json must not have '{}', it is added by the writer", name, key));
    }
  }
  run.update(given);
  run[kJsonHash] = kHashPlaceholder;
}

void WriteNewFile(const fs::path& path, std::string_view bytes) {
  int file = -1;
  do {
    file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  } while (file < 0 && errno == EINTR);
  if (file < 0) ThrowIoError("write", path, errno, bytes.size());
  try {
    WriteAll(file, bytes, path);
  } catch (...) {
    ::close(file);
    throw;
  }
  if (::close(file) != 0) ThrowIoError("write", path, errno, bytes.size());
}

void DescribeEpisode(const EpisodeContent& content, const EpisodeSummary& summary,
                     const EpisodeResults& results) {
  Json description = {{"format", kEpisodeFormat},
                      {"format_version", kEpisodeFormatVersion},
                      {"id", content.id},
                      {"success", summary.success},
                      {"terminated", summary.terminated},
                      {"truncated", summary.truncated},
                      {"end_reason", summary.end_reason},
                      {"warnings", summary.warnings},
                      {"results", results.results},
                      {"tables", TablesOf(content)},
                      {"cameras", CamerasOf(content)},
                      {"metadata", content.metadata},
                      {"versions", VersionsOf(content)},
                      {"models", content.models},
                      {"files", FilesOf(content)},
                      {"run", results.run}};
  if (HasSegmentation(content.schema)) description["segmentation"] = LabelsOf(content.schema);
  if (!content.features.empty()) description["features"] = content.features;
  const std::string text = description.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  WriteNewFile(content.folder / kEpisodeFile, InsertSelfHash(text));
}

void PutInPlace(WorkFolder& work, const fs::path& final) {
  ::rmdir(final.c_str());  // removes only an empty folder; others are reported
  work.Commit(final);
}

}  // namespace robocell::internal
