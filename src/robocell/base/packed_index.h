// The index of a packed dataset (`robocell pack`): which bytes of which shard are a file of an
// episode.
//
//   if (const auto index = PackedIndexOf("out/picks.packed"))
//     for (const std::string& id : index->episodes) Use(index->parts.at(id + "/episode.json"));
//
// A packed dataset is a folder with packed.json and shards, which are zip files without
// compression. They contain the episodes. All other files of the dataset (dataset.json, models,
// reports) lie beside the shards, where they were in the dataset. A folder with packed.json has no
// other episodes than those of the index. Any thread; also in a forked child.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace robocell::internal {

inline constexpr std::string_view kPackedFile = "packed.json";

// A file of an episode: bytes of a shard.
struct FilePart {
  std::filesystem::path shard;
  uint64_t begin = 0;
  uint64_t bytes = 0;
  std::string sha256;
};

struct PackedShard {
  std::string file;  // its name
  uint64_t bytes = 0;
  std::string rest_sha256;  // hash of all bytes that are of no episode: the tables of the zip file
  std::vector<std::string> parts;  // in the order of their bytes
};

// A file beside the shards.
struct PackedFacts {
  uint64_t bytes = 0;
  std::string sha256;
};

struct PackedIndex {
  std::vector<std::string> episodes;  // sorted
  std::vector<PackedShard> shards;
  std::map<std::string, FilePart, std::less<>> parts;  // by "s0000_e0000/steps.h5"
  std::map<std::string, PackedFacts> files;            // by "models/rc7-0123456789abcdef/rc7.xml"

  bool Contains(std::string_view episode) const;
  // Returns the names of an episode's files.
  std::vector<std::string> FilesOf(std::string_view episode) const;
};

bool IsPacked(const std::filesystem::path& folder);

// Returns nothing if the folder is not a packed dataset. Throws IoError if its index is damaged or
// of another version. An index that did not change is read once.
std::shared_ptr<const PackedIndex> PackedIndexOf(const std::filesystem::path& folder);

// Returns the index if a path is, or would be, in the folder of an episode of a packed dataset.
std::shared_ptr<const PackedIndex> IndexAround(const std::filesystem::path& file);

// Throws ArgumentError that names the next step if the folder is a packed dataset. `action`:
// "record episodes".
void RequireNotPacked(const std::filesystem::path& folder, std::string_view action);

}  // namespace robocell::internal
