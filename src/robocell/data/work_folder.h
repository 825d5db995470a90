// A hidden folder to write into until it is complete: locked, so that others can tell it from what
// a crash left behind. Internal to data/.
#pragma once

#include <filesystem>

#include "robocell/data/file_lock.h"

namespace robocell {

// Removed when it goes out of scope, unless Commit() gave it its name.
class WorkFolder {
 public:
  // In `parent`, which must exist, under a temporary name made from `name`. IoError.
  WorkFolder(const std::filesystem::path& parent, const std::string& name);
  ~WorkFolder();
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  // As CommitDirectory. Whether it is in place says committed(), also after an error.
  void Commit(const std::filesystem::path& final);
  bool committed() const { return committed_; }

 private:
  std::filesystem::path path_;
  std::optional<FileLock> lock_;
  bool committed_ = false;
};

}  // namespace robocell
