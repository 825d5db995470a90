#include "robocell/data/episode_verifier.h"

#include <fmt/format.h>

#include <optional>
#include <string>
#include <system_error>
#include <nlohmann/json.hpp>

#include "robocell/base/checked_json.h"
#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/io_error.h"
#include "robocell/base/paths.h"
#include "robocell/base/stored_file.h"
#include "robocell/base/suggestions.h"
#include "robocell/data/episode_files.h"
#include "robocell/data/episode_reader.h"
#include "robocell/data/isolated_reader.h"
#include "robocell/media/video_info.h"

namespace robocell::internal {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::vector<std::string> ColumnsOfWrongLength(const fs::path& folder) {
  const Episode episode(folder, StepsBytes::kCompared);
  std::vector<std::string> found;
  for (const ColumnInfo& column : episode.columns()) {
    if (column.table.empty() || column.rows == episode.rows(column.table)) continue;
    found.push_back(fmt::format("column '{}' has {}, table '{}' {}", column.spec.name,
                                Counted(column.rows, "row"), column.table,
                                episode.rows(column.table)));
  }
  return found;
}

// Calls `look` with every frame.
template <class Pixel, class Look>
void ForEachFrame(VideoReader& video, Look&& look) {
  std::vector<Pixel> frame(video.frame_bytes() / sizeof(Pixel));
  while (video.Next(frame)) look(frame);
}

void Decode(VideoReader video) {
  if (video.info().kind == VideoKind::kGray16)
    ForEachFrame<uint16_t>(video, [](const auto&) {});
  else
    ForEachFrame<uint8_t>(video, [](const auto&) {});
}

// Returns the first number of a segmentation video that has no label.
std::optional<uint16_t> StrayLabel(VideoReader video, size_t labels) {
  std::optional<uint16_t> stray;
  ForEachFrame<uint16_t>(video, [&](const std::vector<uint16_t>& frame) {
    for (const uint16_t label : frame) {
      if (label >= labels && label != kNoSegment && !stray) stray = label;
    }
  });
  return stray;
}

class EpisodeVerification {
 public:
  EpisodeVerification(fs::path folder, bool decode, IsolatedReader& columns)
      : folder_(std::move(folder)), decode_(decode), columns_(columns) {}

  std::vector<VerifyProblem> Run() {
    try {
      StoredNames(folder_);  // a missing folder is only a problem in a readable one
      if (ReadDescription()) VerifyEverything();
    } catch (const std::exception& error) {
      Report("", error.what(), KindOf(error));
    }
    return problems_;
  }

 private:
  void Report(const std::string& file, const std::string& reason,
              ProblemKind kind = ProblemKind::kDamage) {
    problems_.push_back({folder_.filename().string(), file, reason, kind});
  }

  // Returns false if no other check is possible.
  bool ReadDescription() {
    const std::string file(kEpisodeFile);
    const std::string what = WhatIsStoredAt(folder_ / file);
    if (what == "nothing") {
      Report(file, "it is missing: the episode was never finished, or it was removed");
      return false;
    }
    if (!CanReadStoredFile(folder_ / file)) {
      Report(file, fmt::format("it is {}, not a file", what));
      return false;
    }
    const std::string text = ReadStoredFile(folder_ / file);
    if (const auto damage = JsonDamage(text)) {
      Report(file, *damage);
      return false;
    }
    description_ = Json::parse(text);
    if (!IsOfThisVersion()) return false;
    if (description_.value("id", "") != folder_.filename().string()) {
      Report(file, fmt::format(
                       "it describes episode '{}': the folder was copied or renamed, and does not "
                       "count. Remove the copy, or give the folder its name back",
                       description_.value("id", "")));
    }
    return true;
  }

  void VerifyEverything() {
    for (const auto& [name, facts] : description_.at("files").items()) VerifyFile(name, facts);
    const bool whole = problems_.empty();
    VerifyNothingElse();
    if (whole) VerifyContents();
  }

  // Only the version of robocell that wrote an episode knows its files and where they are listed.
  bool IsOfThisVersion() {
    const auto version = JsonCount<int>(description_.at("format_version"));
    if (version == kEpisodeFormatVersion) return true;
    Report(std::string(kEpisodeFile),
           fmt::format("format version {} is not {}, which this robocell reads", version,
                       kEpisodeFormatVersion),
           ProblemKind::kUnreadable);
    return false;
  }

  void VerifyFile(const std::string& name, const Json& facts) {
    if (!ValidFileName(name))
      return Report(std::string(kEpisodeFile), "it lists a file '" + name + "'");
    const fs::path path = folder_ / name;
    const std::string what = WhatIsStoredAt(path);
    if (what == "nothing") return Report(name, "it is missing");
    if (!CanReadStoredFile(path)) return Report(name, fmt::format("it is {}, not a file", what));
    try {
      if (const auto reason = WrongBytes(path, facts)) Report(name, *reason);
    } catch (const IoError& error) {
      Report(name, error.what(), KindOf(error));
    }
  }

  static std::optional<std::string> WrongBytes(const fs::path& path, const Json& facts) {
    const auto expected = JsonCount<uint64_t>(facts.at("bytes"));
    const uint64_t size = StoredFileBytes(path);
    if (size < expected)
      return fmt::format("it is cut short: {} of {} bytes are there", size, expected);
    if (size > expected) return fmt::format("{} bytes, expected {}", size, expected);
    if (Sha256StoredFile(path) != facts.at("sha256").get<std::string>())
      return "its hash does not match its bytes";
    return std::nullopt;
  }

  void VerifyNothingElse() {
    for (const std::string& name : StoredNames(folder_)) {
      if (name == kEpisodeFile || description_.at("files").contains(name)) continue;
      Report(name, "it does not belong to the episode: episode.json does not list it",
             ProblemKind::kForeign);
    }
  }

  void VerifyContents() {
    try {
      for (const std::string& reason : columns_.Ask(folder_.string()))
        Report(std::string(kStepsFile), reason);
    } catch (const Error& error) {
      return Report(std::string(kStepsFile), error.what(), KindOf(error));
    }
    const Episode episode(folder_);
    for (const CameraInfo& camera : episode.cameras()) VerifyCamera(episode, camera);
  }

  // `open` returns the reader of this video, which must hold one frame per row.
  template <class Open>
  void VerifyVideo(const Episode& episode, const CameraInfo& camera, const std::string& file,
                   VideoKind kind, Open&& open) {
    try {
      const VideoInfo info = ReadVideoInfo(folder_ / file);
      const int64_t rows = episode.rows(camera.table);
      if (info.kind != kind) return Report(file, "it is a video of another kind");
      if (info.frames != rows)
        Report(file, fmt::format("it has {} for {}", Counted(info.frames, "frame"),
                                 Counted(rows, "row")));
    } catch (const IoError& error) {
      return Report(file, error.what(), KindOf(error));
    }
    if (decode_) TryToDecode(file, [&] { Decode(open()); });
  }

  // The bytes are those of the encoder, so only this machine's decoder fails.
  template <class F>
  void TryToDecode(const std::string& file, F&& decode) {
    try {
      decode();
    } catch (const IoError& error) {
      Report(file, error.what(), ProblemKind::kUnreadable);
    }
  }

  void VerifyCamera(const Episode& episode, const CameraInfo& camera) {
    VerifyVideo(episode, camera, camera.file, VideoKind::kColour,
                [&] { return episode.Video(camera.name); });
    if (!camera.depth_file.empty()) {
      VerifyVideo(episode, camera, camera.depth_file, VideoKind::kGray16,
                  [&] { return episode.DepthVideo(camera.name); });
    }
    if (!camera.segmentation_file.empty()) VerifySegmentation(episode, camera);
  }

  void VerifySegmentation(const Episode& episode, const CameraInfo& camera) {
    const std::string& file = camera.segmentation_file;
    const size_t before = problems_.size();
    VerifyVideo(episode, camera, file, VideoKind::kGray16,
                [&] { return episode.SegmentationVideo(camera.name); });
    if (!decode_ || problems_.size() != before) return;
    TryToDecode(file, [&] {
      const size_t labels = episode.segment_labels().size();
      if (const auto stray = StrayLabel(episode.SegmentationVideo(camera.name), labels))
        Report(file, fmt::format("a pixel of it is {}, and episode.json has {}", *stray,
                                 Counted(labels, "label")));
    });
  }

  fs::path folder_;
  bool decode_;
  IsolatedReader& columns_;
  Json description_;
  std::vector<VerifyProblem> problems_;
};

}  // namespace

EpisodeVerifier::EpisodeVerifier(bool decode)
    : decode_(decode),
      columns_([](const std::string& folder) { return ColumnsOfWrongLength(folder); }) {}

std::vector<VerifyProblem> EpisodeVerifier::Verify(const fs::path& folder) {
  return EpisodeVerification(folder, decode_, columns_).Run();
}

}  // namespace robocell::internal
