#include "robocell/data/work_folder.h"

#include <fcntl.h>
#include <sys/stat.h>

#include <cerrno>
#include <system_error>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/io_error.h"
#include "robocell/data/episode_files.h"

namespace robocell::internal {

namespace fs = std::filesystem;

namespace {

// Returns true if the path still leads to the file that is open.
bool IsAt(const fs::path& path, int descriptor) {
  struct stat named = {}, open = {};
  return ::stat(path.c_str(), &named) == 0 && ::fstat(descriptor, &open) == 0 &&
         named.st_dev == open.st_dev && named.st_ino == open.st_ino;
}

// Between its creation and its locking a new folder looks like a leftover, and may be removed
// (leftovers.h).
std::optional<FileLock> LockIfStillThere(const fs::path& folder) {
  std::error_code gone;
  try {
    std::optional<FileLock> lock = TryLockOfWork(folder, LockKind::kExclusive);
    if (lock && IsAt(folder / kLockFile, lock->descriptor())) return lock;
  } catch (const IoError&) {
    if (fs::exists(folder, gone)) throw;
  }
  return std::nullopt;
}

}  // namespace

std::optional<FileLock> TryLockOfWork(const fs::path& folder, LockKind kind) {
  return FileLock::Try(folder / kLockFile, kind);
}

WorkFolder::WorkFolder(const fs::path& parent, const std::string& name) {
  constexpr int kTries = 100;
  try {
    for (int i = 0; i < kTries && !lock_; ++i) {
      Remove();
      folder_ = MakeTempDirectory(parent, name);
      lock_ = LockIfStillThere(folder_);
    }
    if (!lock_) throw IoError("cannot lock a folder in '" + parent.string() + "'");
    path_ = folder_ / "content";
    if (::mkdir(path_.c_str(), 0777) != 0) ThrowIoError("create", path_, errno);
  } catch (...) {
    Remove();
    throw;
  }
}

WorkFolder::~WorkFolder() { Remove(); }

// Unlocks first: some file systems keep a removed file's name, and so the folder, while it is open.
// A concurrent cleaner does the same.
void WorkFolder::Remove() noexcept {
  std::error_code ignored;
  lock_.reset();
  if (!folder_.empty()) fs::remove_all(folder_, ignored);
}

void WorkFolder::Commit(const fs::path& final) {
  try {
    CommitDirectory(path_, final);
  } catch (...) {
    std::error_code ignored;
    committed_ = !fs::exists(path_, ignored);
    throw;
  }
  committed_ = true;
}

}  // namespace robocell::internal
