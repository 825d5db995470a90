#include "robocell/data/dataset_lock.h"

#include <fcntl.h>
#include <unistd.h>
#include <fmt/format.h>

#include <cerrno>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/host.h"
#include "robocell/base/io_error.h"
#include "robocell/data/episode_files.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;

void CreateIfMissing(const fs::path& path) {
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor < 0) ThrowIoError("lock", path, errno);
  ::close(descriptor);
}

// Whose lock it is, for messages of others; nobody depends on it.
void WriteOwner(const fs::path& path) {
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_TRUNC | O_CLOEXEC);
  if (descriptor < 0) return;
  const std::string owner = fmt::format("process {} on {}\n", ::getpid(), HostName());
  [[maybe_unused]] const ssize_t written = ::write(descriptor, owner.data(), owner.size());
  ::close(descriptor);
}

std::string Owner(const fs::path& path) {
  std::string owner = ReadFile(path);
  while (!owner.empty() && owner.back() == '\n') owner.pop_back();
  return owner.empty() ? "" : " by " + owner;
}

FileLock Take(const fs::path& dataset, const std::string& name, LockKind kind) {
  const fs::path path = dataset / name;
  CreateIfMissing(path);
  std::optional<FileLock> lock = FileLock::Try(path, kind);
  if (!lock) {
    throw IoError(
        fmt::format("'{}' is in use{}. Wait for it, stop it, or take another folder for the "
                    "dataset (`output`)",
                    dataset.string(), Owner(path)));
  }
  if (kind == LockKind::kExclusive) WriteOwner(path);
  return std::move(*lock);
}

}  // namespace

DatasetLock::DatasetLock(const fs::path& dataset, int shard, int count) {
  const std::string whole(kLockFile);
  held_.push_back(Take(dataset, whole, count == 1 ? LockKind::kExclusive : LockKind::kShared));
  if (count == 1) return;
  held_.push_back(
      Take(dataset, fmt::format("{}-{}-of-{}", whole, shard, count), LockKind::kExclusive));
}

}  // namespace robocell
