// A hidden folder to write into until it is complete. It is locked, so that others can distinguish
// it from leftovers of a crash. Internal to data/.
//
//   .e1.4711.3.partial/.lock      held as long as somebody writes; folders cannot be locked
//   .e1.4711.3.partial/content    what gets the final name
#pragma once

#include <filesystem>

#include "robocell/data/file_lock.h"

namespace robocell::internal {

// Removed when it goes out of scope, unless Commit() gave it its name.
class WorkFolder {
 public:
  // Creates it in `parent`, which must exist, under a temporary name made from `name`. Throws
  // IoError.
  WorkFolder(const std::filesystem::path& parent, const std::string& name);
  ~WorkFolder();
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;

  // The folder to write into.
  const std::filesystem::path& path() const { return path_; }
  // Commits like CommitDirectory. committed() returns whether it is in place, also after an error.
  void Commit(const std::filesystem::path& final);
  bool committed() const { return committed_; }

 private:
  void Remove() noexcept;
  std::filesystem::path folder_;
  std::filesystem::path path_;
  std::optional<FileLock> lock_;
  bool committed_ = false;
};

// Locks a work folder of this or another process, like FileLock::Try.
std::optional<FileLock> TryLockOfWork(const std::filesystem::path& folder, LockKind kind);

}  // namespace robocell::internal
