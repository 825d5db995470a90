// Folders of caches: entries that are used least go first when the folder becomes too large.
//
//   MarkUsed(entry);                                    // whenever it is read
//   PruneFolder(folder, ".npz", most_bytes);            // whenever one is added
//
// Any number of threads and processes may use one folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace robocell::internal {

// Sets the time at which a file was last used to now, if the file may be changed.
void MarkUsed(const std::filesystem::path& file);

// Removes the least recently used files that end in `suffix` until `most_bytes` are left.
void PruneFolder(const std::filesystem::path& folder, const std::string& suffix,
                 uint64_t most_bytes);

}  // namespace robocell::internal
