// An advisory lock on a file, held until it goes out of scope. The system frees the locks of a
// process that dies, however it dies. Internal to data/; the public faces are DatasetLock and
// EpisodeWriter.
#pragma once

#include <filesystem>
#include <optional>

namespace robocell {

enum class LockKind { kShared, kExclusive };

class FileLock {
 public:
  // Returns the lock; unset if another owner in this process or another one holds it. Creates the
  // file for an exclusive lock; for a shared one it must exist and need not be writable. Throws
  // IoError if it cannot be opened, or locking fails.
  static std::optional<FileLock> Try(const std::filesystem::path& path, LockKind kind);

  FileLock(FileLock&& other) noexcept;
  FileLock& operator=(FileLock&& other) noexcept;
  ~FileLock();

  // Returns false on a file system without locks, where every caller gets one and none is kept out.
  // A warning reports that once.
  bool holds() const { return holds_; }
  int descriptor() const { return descriptor_; }

 private:
  explicit FileLock(int descriptor) : descriptor_(descriptor) {}
  int descriptor_ = -1;
  bool holds_ = false;
};

}  // namespace robocell
