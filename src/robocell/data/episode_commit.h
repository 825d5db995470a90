// Commits an episode, in an order that leaves it complete or absent at any instant. EpisodeWriter
// closes the files; then
//   1. DescribeEpisode writes episode.json beside them, with their hashes;
//   2. the models that the episode names are stored in the dataset (model_store.h);
//   3. PutInPlace flushes everything and gives the folder its name.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>
#include <nlohmann/json.hpp>

#include "robocell/data/episode_schema.h"
#include "robocell/data/episode_writer.h"
#include "robocell/data/work_folder.h"

namespace robocell::internal {

// Parses a JSON object that the caller gave as text, and sorts its keys. Throws ArgumentError that
// begins with `where` and names `what`.
nlohmann::ordered_json ParseObject(const std::string& where, const std::string& what,
                                   const std::string& text);

// Returns "2026-01-31T12:00:00.000Z".
std::string UtcNow();

// An episode whose files are closed.
struct EpisodeContent {
  struct Frames {
    int64_t colour = 0, depth = 0, segmentation = 0;
  };
  std::string id;
  std::string name;              // name for messages
  std::filesystem::path folder;  // folder of its files
  const EpisodeSchema& schema;
  std::vector<int64_t> rows = {};   // rows of each table of the schema
  std::vector<Frames> frames = {};  // frames of each of its cameras
  const nlohmann::ordered_json& metadata;
  const nlohmann::ordered_json& features;  // empty for none
  const nlohmann::ordered_json& versions;  // beside robocell's own
  const nlohmann::ordered_json& models;
  const std::vector<std::string>& extra_files;
};

// The caller's results. Throws ArgumentError for texts that are not JSON objects and for keys of
// `run` that the writer adds itself: check it before anything is closed.
struct EpisodeResults {
  EpisodeResults(const std::string& name, const std::string& started,
                 const EpisodeSummary& summary);
  nlohmann::ordered_json results;
  nlohmann::ordered_json run;
};

// Writes a new file into the episode's folder. It is not on the disk before PutInPlace, which
// flushes all files at once.
void WriteNewFile(const std::filesystem::path& path, std::string_view bytes);

// Writes episode.json into the episode's folder.
void DescribeEpisode(const EpisodeContent& content, const EpisodeSummary& summary,
                     const EpisodeResults& results);

// Gives the work folder its name; it replaces an empty folder of that name and throws IoError for
// any other entry. After an error work.committed() returns whether it is in place all the same.
void PutInPlace(WorkFolder& work, const std::filesystem::path& final);

}  // namespace robocell::internal
