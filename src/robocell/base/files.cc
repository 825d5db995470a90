#include "robocell/base/files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <memory>
#include <optional>
#include <system_error>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/io_error.h"
#include "robocell/base/paths.h"
#include "robocell/base/temporary_name.h"

namespace robocell {
namespace fs = std::filesystem;
namespace {

constexpr size_t kBlock = 1 << 18;  // fits into the processor's cache until it is used

enum SyncKind { kContent, kFolder };

// Owns a descriptor.
class File {
 public:
  File(const fs::path& path, int flags, std::string_view action) : File(path, flags) {
    if (descriptor_ < 0) ThrowIoError(action, path, errno);
  }
  // Leaves the reason in errno when the file cannot be opened.
  File(const fs::path& path, int flags) : path_(path) {
    do {
      descriptor_ = ::open(path.c_str(), flags | O_CLOEXEC, 0666);
    } while (descriptor_ < 0 && errno == EINTR);
  }
  File(File&& other) noexcept
      : descriptor_(std::exchange(other.descriptor_, -1)), path_(std::move(other.path_)) {}
  File& operator=(File&&) = delete;
  ~File() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }

  int descriptor() const { return descriptor_; }

  // `needed_bytes`: for the message about a full disk.
  void Sync(SyncKind kind, std::optional<uint64_t> needed_bytes = std::nullopt) {
    int result;
    do {
      result = ::fsync(descriptor_);
    } while (result != 0 && errno == EINTR);
    if (result == 0) return;
    // Some network file systems have no flush for folders: their entries need none.
    if (kind == kFolder && (errno == EINVAL || errno == ENOTSUP)) return;
    ThrowIoError("flush", path_, errno, needed_bytes);
  }

  // Some file systems report a failed write only here.
  void Close() {
    if (::close(std::exchange(descriptor_, -1)) != 0 && errno != EINTR) {
      ThrowIoError("close", path_, errno);
    }
  }

 private:
  int descriptor_ = -1;
  fs::path path_;
};

fs::path ParentOf(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

std::pair<File, fs::path> CreateTemporaryFile(const fs::path& target, uint64_t bytes) {
  for (;;) {
    fs::path path = TemporaryPath(ParentOf(target), target.filename().native());
    File file(path, O_WRONLY | O_CREAT | O_EXCL);
    if (file.descriptor() >= 0) return {std::move(file), std::move(path)};
    if (errno != EEXIST) ThrowIoError("write", target, errno, bytes);
  }
}

void WriteAndSync(File& file, std::string_view bytes, const fs::path& path) {
  WriteAll(file.descriptor(), bytes, path);
  file.Sync(kContent, bytes.size());
  file.Close();
}

void SyncTree(const fs::path& folder) {
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const fs::file_type type = it->symlink_status().type();
    if (type == fs::file_type::directory) {
      SyncTree(it->path());
    } else if (type == fs::file_type::regular) {
      FsyncFile(it->path());
    } else {
      throw IoError(fmt::format("cannot commit '{}': it is neither a file nor a folder",
                                it->path().native()));
    }
  }
  if (error) ThrowIoError("list", folder, error.value());
  FsyncDirectory(folder);
}

// After a rename the new name is in place and stays; only a power cut may still undo it.
void FlushRename(const fs::path& path) {
  try {
    FsyncDirectory(ParentOf(path));
  } catch (const IoError& error) {
    throw IoError(fmt::format("'{}' is in place, but a power cut may still undo that: {}",
                              path.native(), error.what()));
  }
}

// Calls rename(2) such that it never replaces anything, if the file system can do that; otherwise
// checks first.
void RenameToNew(const fs::path& from, const fs::path& to) {
  if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return;
  if (errno == EINVAL || errno == ENOSYS) {
    std::error_code ignored;
    if (fs::symlink_status(to, ignored).type() != fs::file_type::not_found) {
      ThrowIoError("commit to", to, EEXIST);
    }
    if (::rename(from.c_str(), to.c_str()) == 0) return;
  }
  ThrowIoError("commit to", to, errno);
}

}  // namespace

fs::path TemporaryPath(const fs::path& parent, std::string_view name) {
  static std::atomic<uint64_t> count = 0;
  internal::RequireNoNul("file", (parent / name).native());
  return parent / internal::TemporaryName{std::string(name), ::getpid(), ++count}.Text();
}

std::string ReadFile(const fs::path& path) {
  File file(path, O_RDONLY, "read");
  struct stat status = {};
  if (::fstat(file.descriptor(), &status) != 0) ThrowIoError("read", path, errno);
  std::string bytes;
  bytes.resize(static_cast<size_t>(status.st_size) + 1);  // one more, to detect the end
  size_t size = 0;
  for (;;) {
    const ssize_t count = ::read(file.descriptor(), bytes.data() + size, bytes.size() - size);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) ThrowIoError("read", path, errno);
    if (count == 0) break;
    size += static_cast<size_t>(count);
    if (size == bytes.size()) bytes.resize(2 * size);  // it grows, or is in /proc
  }
  bytes.resize(size);
  return bytes;
}

void ReadBlocks(const fs::path& path, const std::function<void(std::string_view)>& f) {
  const File file(path, O_RDONLY, "read");
  ReadBlocks(file.descriptor(), path, f);
}

void ReadBlocks(int descriptor, const fs::path& path,
                const std::function<void(std::string_view)>& f) {
  const auto block = std::make_unique_for_overwrite<char[]>(kBlock);
  for (;;) {
    const ssize_t count = ::read(descriptor, block.get(), kBlock);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) ThrowIoError("read", path, errno);
    if (count == 0) return;
    f({block.get(), static_cast<size_t>(count)});
  }
}

void WriteAll(int descriptor, std::string_view bytes, const fs::path& path) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(descriptor, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) ThrowIoError("write", path, errno, bytes.size());
    bytes.remove_prefix(static_cast<size_t>(count));
  }
}

void AtomicWrite(const fs::path& path, std::string_view bytes) {
  auto [file, temporary] = CreateTemporaryFile(path, bytes.size());
  try {
    WriteAndSync(file, bytes, path);
    if (::rename(temporary.c_str(), path.c_str()) != 0)
      ThrowIoError("write", path, errno, bytes.size());
  } catch (...) {
    ::unlink(temporary.c_str());
    throw;
  }
  FlushRename(path);
}

void FsyncFile(const fs::path& path) { File(path, O_RDONLY, "flush").Sync(kContent); }

void FsyncDirectory(const fs::path& path) {
  File(path, O_RDONLY | O_DIRECTORY, "flush").Sync(kFolder);
}

fs::path MakeTempDirectory(const fs::path& parent, std::string_view name) {
  for (;;) {
    fs::path path = TemporaryPath(parent, name);
    if (::mkdir(path.c_str(), 0777) == 0) return path;
    if (errno != EEXIST) ThrowIoError("create a folder in", parent, errno);
  }
}

fs::path MakeTempFile(const fs::path& target) {
  auto [file, path] = CreateTemporaryFile(target, 0);
  file.Close();
  return path;
}

bool IsTemporaryName(std::string_view file_name) {
  return file_name.starts_with('.') && file_name.ends_with(internal::TemporaryName::kSuffix);
}

void CommitDirectory(const fs::path& temporary, const fs::path& final) {
  SyncTree(temporary);
  RenameToNew(temporary, final);
  FlushRename(final);
}

namespace {

// A range-based loop would throw the system's own error if the folder becomes unreadable.
std::vector<std::string> ReadNames(const std::filesystem::path& folder, std::error_code& error) {
  std::vector<std::string> names;
  for (std::filesystem::directory_iterator it(folder, error), end; !error && it != end;
       it.increment(error)) {
    names.push_back(it->path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace

std::vector<std::string> FolderNames(const std::filesystem::path& folder) {
  std::error_code error;
  std::vector<std::string> names = ReadNames(folder, error);
  if (error) ThrowIoError("list", folder, error.value());
  return names;
}

std::vector<std::string> FolderNamesIfAny(const std::filesystem::path& folder) {
  std::error_code ignored;
  return ReadNames(folder, ignored);
}

}  // namespace robocell
