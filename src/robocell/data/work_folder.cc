#include "robocell/data/work_folder.h"

#include <system_error>

#include "robocell/base/error.h"
#include "robocell/base/files.h"

namespace robocell {

namespace fs = std::filesystem;

namespace {

// Between its making and its locking a new folder looks like one that was left behind, and may be
// swept away (leftovers.h).
std::optional<FileLock> LockIfStillThere(const fs::path& folder) {
  std::error_code gone;
  try {
    std::optional<FileLock> lock = FileLock::Try(folder, LockKind::kExclusive);
    if (lock && fs::exists(folder, gone)) return lock;
  } catch (const IoError&) {
    if (fs::exists(folder, gone)) throw;
  }
  return std::nullopt;
}

}  // namespace

WorkFolder::WorkFolder(const fs::path& parent, const std::string& name) {
  constexpr int kTries = 100;
  for (int i = 0; i < kTries && !lock_; ++i) {
    path_ = MakeTempDirectory(parent, name);
    lock_ = LockIfStillThere(path_);
  }
  if (!lock_) throw IoError("cannot lock a folder in '" + parent.string() + "'");
}

WorkFolder::~WorkFolder() {
  std::error_code ignored;
  if (!committed_) fs::remove_all(path_, ignored);
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

}  // namespace robocell
