// The files of episodes: a file of its own, or a part of a shard of a packed dataset
// (packed_index.h). Like real_file.h otherwise.
//
//   const std::string text = ReadStoredFile(dataset / id / "episode.json");
//
// In a packed dataset the folder of an episode does not exist; its path still names the episode.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "robocell/base/packed_index.h"
#include "robocell/base/real_file.h"

namespace robocell {

// Returns the part of a shard that is this file; unset for a file of its own, and without one.
std::optional<internal::FilePart> PartAt(const std::filesystem::path& path);

// Returns the word by which ffmpeg opens the file: "file:wrist.mp4", or its bytes in a shard.
std::string FfmpegInput(const std::filesystem::path& path);

namespace internal {

// Returns "a file" for a part whose shard is there; see WhatIsAt for all else.
std::string WhatIsStoredAt(const std::filesystem::path& path);
bool CanReadStoredFile(const std::filesystem::path& path);
const std::filesystem::path& RequireStoredFile(const std::filesystem::path& path);
// Returns the size; of a part as much of it as its shard contains. Throws IoError without a file.
uint64_t StoredFileBytes(const std::filesystem::path& path);
std::string StoredFileIdentity(const std::filesystem::path& path);
std::string ReadStoredFile(const std::filesystem::path& path,
                           uint64_t max_bytes = kMaxDescriptionBytes);
std::string Sha256StoredFile(const std::filesystem::path& path);
// Returns the names in the folder of an episode, sorted.
std::vector<std::string> StoredNames(const std::filesystem::path& folder);

// Calls f(bytes) for `count` bytes from `begin` on, block by block. Throws IoError if the file is
// shorter.
void ReadRange(const std::filesystem::path& file, uint64_t begin, uint64_t count,
               const std::function<void(std::string_view)>& f);

}  // namespace internal
}  // namespace robocell
