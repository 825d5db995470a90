// The layout of an episode's folder and of episode.json: what writer, reader and verify share.
// Internal to data/.
//
// episode.json carries a hash of itself (run.json_sha256): of its own text with that hash replaced
// by zeros. It sits in the `run` block, which is the only part that differs between two runs of the
// same episode.
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
inline constexpr std::string_view kReportFile = "report.json";  // of a shard: report-3-of-8.json
inline constexpr std::string_view kLockFile = ".lock";          // of a shard: .lock-3-of-8

// The text of episode.json before it is signed has this where the hash goes.
inline constexpr std::string_view kUnsigned =
    "0000000000000000000000000000000000000000000000000000000000000000";

// Puts the hash in. `text` must contain `"json_sha256": "<kUnsigned>"` exactly once.
std::string SignEpisodeJson(std::string text);
// Whether the text is exactly what was signed.
bool EpisodeJsonIsIntact(const std::string& text);

// A run's own account, beside the episodes; no part of them.
inline bool IsReportFile(std::string_view name) {
  return name == kReportFile || (name.starts_with("report-") && name.ends_with(".json"));
}

inline std::string VideoFile(std::string_view camera) { return std::string(camera) + ".mp4"; }
inline std::string DepthFile(std::string_view camera) { return std::string(camera) + ".depth.mov"; }

}  // namespace robocell
