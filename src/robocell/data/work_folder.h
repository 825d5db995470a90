// A hidden folder to write into until it is complete. It is locked, so that others can distinguish
// it from what a crash left behind. Internal to data/.
//
//   .e1.4711.3.partial/.lock      held as long as somebody writes; folders cannot be locked
//   .e1.4711.3.partial/content    what gets the final name
#pragma once

#include <filesystem>

#include "robocell/data/file_lock.h"

namespace robocell::internal {

// Removed when it goes out of scope; what Commit() gave its name stays.
class WorkFolder {
 public:
  // In `parent`, which must exist, under a temporary name made from `name`. IoError.
  WorkFolder(const std::filesystem::path& parent, const std::string& name);
  ~WorkFolder();
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;

  // The folder to write into.
  const std::filesystem::path& path() const { return path_; }
  // As CommitDirectory. Whether it is in place says committed(), also after an error.
  void Commit(const std::filesystem::path& final);
  bool committed() const { return committed_; }

 private:
  void Remove() noexcept;
  std::filesystem::path folder_;
  std::filesystem::path path_;
  std::optional<FileLock> lock_;
  bool committed_ = false;
};

// The lock of a work folder, of this process or another's; as FileLock::Try.
std::optional<FileLock> TryLockOfWork(const std::filesystem::path& folder, LockKind kind);

}  // namespace robocell::internal
