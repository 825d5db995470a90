// Finds and removes half-written folders of killed processes in a dataset. Readers never see them;
// they only take space. Folders that are being written now are never touched, because they are
// locked (work_folder.h).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace robocell {

// Whether an unfinished folder has a living writer, on this machine or another. True if the file
// system has no locks.
bool IsBeingWritten(const std::filesystem::path& unfinished);

// Names of unfinished folders and files in the dataset, sorted, with and without a writer; not of
// models that cannot be listed.
std::vector<std::string> UnfinishedIn(const std::filesystem::path& dataset);

struct DeadWriter {
  std::string episode;  // its attempts too: names that begin with it
  int64_t process = 0;
};

// Removes what nobody is writing and returns its names. Of one dead writer (its episode, and models
// that it was storing), or all: that is for
// whoever holds the lock of the whole dataset, as single files are not locked. Process numbers
// alone are not enough: other machines may write into the folder. On a file system without locks
// folders stay.
std::vector<std::string> RemoveLeftovers(const std::filesystem::path& dataset,
                                         const std::optional<DeadWriter>& writer = {});
// The same of folders only, for anybody: beside other shards, say.
std::vector<std::string> RemoveLeftoverFolders(const std::filesystem::path& dataset);
// Of those only the ones of episodes "<prefix>-000017" and so on, and of models: for whoever numbers
// its episodes in this way (DatasetLock::Numbering).
std::vector<std::string> RemoveLeftoversOfNumbering(const std::filesystem::path& dataset,
                                                    const std::string& prefix);

}  // namespace robocell
