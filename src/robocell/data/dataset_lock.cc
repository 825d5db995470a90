#include "robocell/data/dataset_lock.h"

#include <fcntl.h>
#include <unistd.h>
#include <fmt/format.h>

#include <cerrno>
#include <string_view>
#include <system_error>

#include "robocell/base/error.h"
#include "robocell/base/host.h"
#include "robocell/base/io_error.h"
#include "robocell/base/real_file.h"
#include "robocell/data/episode_files.h"
#include "robocell/data/own_folders.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;

void CreateIfMissing(const fs::path& path) {
  const RealFile file(path, O_WRONLY | O_CREAT, "lock");
}

// Whose lock it is, for messages of others; nobody depends on it.
void WriteOwner(const fs::path& path) {
  const RealFile file(path, O_WRONLY | O_TRUNC, "lock");
  const std::string owner = fmt::format("process {} on {}\n", ::getpid(), HostName());
  [[maybe_unused]] const ssize_t written = ::write(file.descriptor(), owner.data(), owner.size());
}

std::string Owner(const fs::path& path) {
  std::string owner = ReadRealFile(path);
  while (!owner.empty() && owner.back() == '\n') owner.pop_back();
  return owner.empty() ? "" : " by " + owner;
}

FileLock Take(const fs::path& dataset, const std::string& name, LockKind kind) {
  const fs::path path = dataset / name;
  RequireOwnFolders(dataset);
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

namespace {

const std::string kWhole(kLockFile);
const std::string kWriters = kWhole + "-writers";

// N of ".lock-i-of-N"; "" of other names.
std::string CountIn(const std::string& name) {
  constexpr std::string_view kOf = "-of-";
  const size_t at = name.rfind(kOf);
  if (!name.starts_with(kWhole + "-") || at == std::string::npos) return "";
  return name.substr(at + kOf.size());
}

void RequireSameCount(const fs::path& dataset, int count) {
  std::error_code error;
  for (fs::directory_iterator it(dataset, error), end; !error && it != end; it.increment(error)) {
    const std::string other = CountIn(it->path().filename().string());
    if (other.empty() || other == std::to_string(count)) continue;
    if (FileLock::Try(it->path(), LockKind::kShared)) continue;
    throw IoError(
        fmt::format("'{}' is in use{} as a shard of {}; a shard of {} beside it would make "
                    "the same episodes again: give all shards the same N",
                    dataset.string(), Owner(it->path()), other, count));
  }
  if (error) ThrowIoError("list", dataset, error.value());
}

}  // namespace

DatasetLock DatasetLock::Writing(const fs::path& dataset) {
  DatasetLock lock;
  lock.held_.push_back(Take(dataset, kWriters, LockKind::kShared));
  return lock;
}

DatasetLock DatasetLock::Alone(const fs::path& dataset) {
  DatasetLock lock(dataset);
  lock.held_.push_back(Take(dataset, kWriters, LockKind::kExclusive));
  return lock;
}

DatasetLock::DatasetLock(const fs::path& dataset, int shard, int count) {
  held_.push_back(Take(dataset, kWhole, count == 1 ? LockKind::kExclusive : LockKind::kShared));
  if (count == 1) return;
  held_.push_back(
      Take(dataset, fmt::format("{}-{}-of-{}", kWhole, shard, count), LockKind::kExclusive));
  RequireSameCount(dataset,
                   count);  // after taking ours: of two that begin at once, one sees the other
}

}  // namespace robocell
