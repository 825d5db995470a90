// An advisory lock on a file or folder, held until it goes out of scope. The system frees the locks
// of a process that dies, however it dies. Internal to data/; the public faces are DatasetLock and
// EpisodeWriter.
#pragma once

#include <filesystem>
#include <optional>

namespace robocell {

enum class LockKind { kShared, kExclusive };

class FileLock {
 public:
  // Unset when somebody else holds it, in this process or another. IoError when `path` cannot be
  // opened. File systems without locks give every lock to everybody.
  static std::optional<FileLock> Try(const std::filesystem::path& path, LockKind kind);

  FileLock(FileLock&& other) noexcept;
  FileLock& operator=(FileLock&& other) noexcept;
  ~FileLock();

  int descriptor() const { return descriptor_; }

 private:
  explicit FileLock(int descriptor) : descriptor_(descriptor) {}
  int descriptor_ = -1;
};

}  // namespace robocell
