#include "robocell/data/dataset_lock.h"

#include <fcntl.h>
#include <unistd.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <sstream>
#include <string_view>
#include <system_error>
#include <thread>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/host.h"
#include "robocell/base/io_error.h"
#include "robocell/base/packed_index.h"
#include "robocell/base/real_file.h"
#include "robocell/data/dataset_folder.h"
#include "robocell/data/episode_files.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;

void CreateIfMissing(const fs::path& path) {
  const internal::RealFile file(path, O_WRONLY | O_CREAT, "lock");
}

const std::string kWhole(kLockFile);
const std::string kWriters = kWhole + "-writers";
const std::string kStart = kWhole + "-start";  // held while a shard takes its lock

// Writes who has an exclusive lock, for messages of others only. The text is never removed: the
// start time shows whether it still belongs to the process of that number.
void WriteOwner(const fs::path& path) {
  const internal::RealFile file(path, O_WRONLY | O_TRUNC, "lock");
  const int64_t self = ::getpid();
  const std::string owner =
      fmt::format("process {} on {}\nsince {}\nat {:%FT%TZ}\n", self, internal::HostName(),
                  internal::ProcessStart(self).value_or(0),
                  std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now()));
  [[maybe_unused]] const ssize_t written = ::write(file.descriptor(), owner.data(), owner.size());
}

// Returns "process 7 on host since 2026-01-31T12:00:00Z"; "" if it is unknown, or has ended.
std::string Owner(const fs::path& path) {
  std::istringstream text(internal::ReadRealFile(path));
  std::string word, host;
  int64_t process = 0;
  uint64_t start = 0;
  if (!(text >> word >> process >> word >> host >> word >> start)) return "";
  if (host == internal::HostName() && internal::ProcessStart(process) != start) return "";
  std::string at;
  text >> word >> at;  // absent in earlier versions
  return fmt::format("process {} on {}{}{}", process, host, at.empty() ? "" : " since ", at);
}

// Returns N of ".lock-i-of-N"; "" for other names.
std::string CountIn(const std::string& name) {
  constexpr std::string_view kOf = "-of-";
  const size_t at = name.rfind(kOf);
  if (!name.starts_with(kWhole + "-") || at == std::string::npos) return "";
  return name.substr(at + kOf.size());
}

// Calls f(path, N) for each held lock of a shard. The check takes the lock for an instant, and so
// gets in the way of its owner: locks of shards of `but_of` are skipped.
template <class F>
void ForEachHeldShard(const fs::path& dataset, const std::string& but_of, F&& f) {
  std::error_code error;
  for (fs::directory_iterator it(dataset, error), end; !error && it != end; it.increment(error)) {
    const std::string count = CountIn(it->path().filename().string());
    if (count.empty() || count == but_of) continue;
    if (!FileLock::Try(it->path(), LockKind::kShared)) f(it->path(), count);
  }
  if (error) ThrowIoError("list", dataset, error.value());
}

// Returns "shards: 0-of-8 (process 7 on host), 3-of-8".
std::string HeldShards(const fs::path& dataset) {
  constexpr size_t kMost = 4;
  std::vector<std::string> shards;
  ForEachHeldShard(dataset, "", [&](const fs::path& path, const std::string&) {
    const std::string owner = Owner(path);
    const std::string shard = path.filename().string().substr(kWhole.size() + 1);
    shards.push_back(owner.empty() ? shard : fmt::format("{} ({})", shard, owner));
  });
  std::sort(shards.begin(), shards.end());
  const size_t all = shards.size();
  if (all > kMost) shards.resize(kMost);
  const std::string more = all > kMost ? fmt::format(" and {} more", all - kMost) : "";
  return all == 0 ? "shards" : fmt::format("shards: {}{}", fmt::join(shards, ", "), more);
}

// Returns who holds a lock; "" if unknown.
std::string Holders(const fs::path& dataset, const std::string& name) {
  const fs::path path = dataset / name;
  if (!FileLock::Try(path, LockKind::kShared)) return Owner(path);  // held exclusively
  return name == kWriters ? "writers of episodes" : HeldShards(dataset);
}

std::string By(const std::string& owner) { return owner.empty() ? "" : " by " + owner; }

// A process that checks whether the lock is held has it for an instant (ForEachHeldShard, Holders).
constexpr int kTries = 25;
constexpr std::chrono::milliseconds kPause(1);

std::optional<FileLock> TryPatiently(const fs::path& path, LockKind kind, int tries = kTries) {
  std::optional<FileLock> lock = FileLock::Try(path, kind);
  for (int i = 1; !lock && i < tries; ++i) {
    std::this_thread::sleep_for(kPause);
    lock = FileLock::Try(path, kind);
  }
  return lock;
}

FileLock Take(const fs::path& dataset, const std::string& name, LockKind kind, int tries = kTries) {
  const fs::path path = dataset / name;
  internal::RequireNotPacked(dataset, "write");
  RequireOwnFolders(dataset);
  CreateIfMissing(path);
  std::optional<FileLock> lock = TryPatiently(path, kind, tries);
  if (!lock) {
    throw IoError(
        fmt::format("'{}' is in use{}. Wait until that is over, end it, or take another folder for "
                    "the dataset (`output`)",
                    dataset.string(), By(Holders(dataset, name))));
  }
  if (kind == LockKind::kExclusive) WriteOwner(path);
  return std::move(*lock);
}

// One shard at a time takes its lock and checks those of others: of two that begin at once, the
// first one gets it, and the second one sees that. It takes milliseconds, more on a network disk.
FileLock TakeTurn(const fs::path& dataset) {
  constexpr std::chrono::seconds kMost(30);
  return Take(dataset, kStart, LockKind::kExclusive, kMost / kPause);
}

void RequireSameCount(const fs::path& dataset, int count) {
  const std::string same = std::to_string(count);
  ForEachHeldShard(dataset, same, [&](const fs::path& path, const std::string& other) {
    throw IoError(
        fmt::format("'{}' is in use{} as a shard of {}; a shard of {} beside it would make "
                    "the same episodes again: give all shards the same N",
                    dataset.string(), By(Owner(path)), other, count));
  });
}

}  // namespace

DatasetLock DatasetLock::Writing(const fs::path& dataset) {
  DatasetLock lock;
  lock.held_.push_back(Take(dataset, kWriters, LockKind::kShared));
  return lock;
}

DatasetLock DatasetLock::Numbering(const fs::path& dataset, const std::string& prefix) {
  DatasetLock lock = Writing(dataset);
  const std::string name = kWhole + "." + prefix;
  const fs::path path = dataset / name;
  CreateIfMissing(path);
  std::optional<FileLock> own = TryPatiently(path, LockKind::kExclusive);
  if (!own) {
    throw IoError(
        fmt::format("episodes '{}-...' of '{}' are being written{}. Wait until that is "
                    "over, or choose another prefix",
                    prefix, dataset.string(), By(Holders(dataset, name))));
  }
  WriteOwner(path);
  lock.held_.push_back(std::move(*own));
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
  const FileLock turn = TakeTurn(dataset);
  held_.push_back(
      Take(dataset, fmt::format("{}-{}-of-{}", kWhole, shard, count), LockKind::kExclusive));
  RequireSameCount(dataset, count);
}

}  // namespace robocell
