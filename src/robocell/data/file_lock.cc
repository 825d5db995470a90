#include "robocell/data/file_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>
#include <fmt/format.h>

#include <atomic>
#include <cerrno>
#include <system_error>
#include <utility>

#include "robocell/base/io_error.h"
#include "robocell/base/log.h"
#include "robocell/base/real_file.h"

namespace robocell {
namespace {

// If flock(2) uses locks of byte ranges, as on NFS, an exclusive lock needs a file that is open for
// writing. A shared lock must be possible without write permission.
int OpenFor(const std::filesystem::path& path, LockKind kind) {
  const int access = kind == LockKind::kExclusive ? O_RDWR | O_CREAT : O_RDONLY;
  return ::open(path.c_str(), access | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0644);
}

bool MeansNoLocks(int error) {
  return error == ENOLCK || error == ENOSYS || error == EOPNOTSUPP || error == ENOTSUP;
}

// Warns once per process: it is the same for every file of a dataset.
void WarnOfNoLocks(const std::filesystem::path& path, int error) {
  static std::atomic<bool> warned = false;
  if (warned.exchange(true)) return;
  LogWarn(
      fmt::format("'{}' cannot be locked ({}): two runs in one folder are not detected there, and "
                  "half-written files of killed processes stay until you remove them",
                  path.string(), std::system_category().message(error)));
}

}  // namespace

std::optional<FileLock> FileLock::Try(const std::filesystem::path& path, LockKind kind) {
  FileLock lock(OpenFor(path, kind));
  if (lock.descriptor_ < 0) internal::ThrowOpenError("lock", path, errno);
  int result;
  do {
    result =
        ::flock(lock.descriptor_, (kind == LockKind::kExclusive ? LOCK_EX : LOCK_SH) | LOCK_NB);
  } while (result != 0 && errno == EINTR);
  const int error = result == 0 ? 0 : errno;
  if (error == EWOULDBLOCK) return std::nullopt;
  if (error != 0 && !MeansNoLocks(error)) ThrowIoError("lock", path, error);
  if (error != 0) WarnOfNoLocks(path, error);
  lock.holds_ = error == 0;
  return lock;
}

FileLock::FileLock(FileLock&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), holds_(other.holds_) {}

FileLock& FileLock::operator=(FileLock&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(holds_, other.holds_);
  return *this;
}

FileLock::~FileLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace robocell
