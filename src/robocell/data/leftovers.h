// Finds and removes half-written folders of killed processes in a dataset. Readers never see them;
// they only take space. Folders that are being written are locked (work_folder.h) and never
// touched.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace robocell {

// Returns true if an unfinished folder has a living writer, on this machine or another, or if the
// file system has no locks.
bool IsBeingWritten(const std::filesystem::path& unfinished);

// Returns names of unfinished folders and files in the dataset, sorted, with and without a writer;
// without models that cannot be listed.
std::vector<std::string> UnfinishedIn(const std::filesystem::path& dataset);

struct DeadWriter {
  std::string episode;  // episode id; includes its attempts (names that begin with it)
  int64_t process = 0;
};

// Removes leftovers without a writer and returns their names: those of one dead writer (its
// episode, and models that it was storing), or all. All is only for the holder of the lock of the
// whole dataset, because single files are not locked. Process numbers alone are not enough: other
// machines may write into the folder. On a file system without locks folders stay.
std::vector<std::string> RemoveLeftovers(const std::filesystem::path& dataset,
                                         const std::optional<DeadWriter>& writer = {});
// Removes only folders; any process may call it, for example beside other shards.
std::vector<std::string> RemoveLeftoverFolders(const std::filesystem::path& dataset);
// Removes folders of episodes "<prefix>-000017" and so on, and of models: for a writer that
// numbers its episodes in this way (DatasetLock::Numbering).
std::vector<std::string> RemoveLeftoversOfNumbering(const std::filesystem::path& dataset,
                                                    const std::string& prefix);

}  // namespace robocell
