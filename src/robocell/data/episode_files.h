// The layout of an episode's folder and of the dataset around it, which writer, reader and verify
// share. Internal to data/.
#pragma once

#include <string>
#include <string_view>

namespace robocell {

inline constexpr std::string_view kEpisodeFormat = "robocell-episode";
inline constexpr int kEpisodeFormatVersion = 1;
inline constexpr std::string_view kStepsFile = "steps.h5";
inline constexpr std::string_view kEpisodeFile = "episode.json";
inline constexpr std::string_view kManifestFile = "dataset.json";
inline constexpr std::string_view kQuarantineFolder = ".quarantine";
inline constexpr std::string_view kModelsFolder = "models";
inline constexpr std::string_view kLogsFolder = ".logs";
inline constexpr std::string_view kReportFile = "report.json";  // a shard has report-3-of-8.json
inline constexpr std::string_view kLockFile = ".lock";          // a shard has .lock-3-of-8

// A run's own report stands beside the episodes and belongs to none.
inline bool IsReportFile(std::string_view name) {
  return name == kReportFile || (name.starts_with("report-") && name.ends_with(".json"));
}

inline std::string VideoFile(std::string_view camera) { return std::string(camera) + ".mp4"; }
inline std::string DepthFile(std::string_view camera) { return std::string(camera) + ".depth.mov"; }
inline std::string SegmentationFile(std::string_view camera) {
  return std::string(camera) + ".segmentation.mov";
}

}  // namespace robocell
