#include "robocell/base/real_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <fmt/format.h>

#include <cerrno>
#include <system_error>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/hash.h"
#include "robocell/base/io_error.h"
#include "robocell/base/paths.h"

namespace robocell::internal {
namespace {

namespace fs = std::filesystem;

std::string LinkAt(const fs::path& path) {
  std::error_code ignored;
  const bool dangling = fs::status(path, ignored).type() == fs::file_type::not_found;
  return fmt::format("a link to '{}'{}", fs::read_symlink(path, ignored).string(),
                     dangling ? ", where there is nothing" : "");
}

[[noreturn]] void ThrowNoFile(std::string_view action, const fs::path& path) {
  throw IoError(
      fmt::format("cannot {} '{}': it is {}, not a file. Remove it, or put the file itself there",
                  action, path.string(), WhatIsAt(path)));
}

}  // namespace

std::string WhatIsAt(const fs::path& path) {
  std::error_code error;
  switch (fs::symlink_status(path, error).type()) {
    case fs::file_type::not_found:
      return "nothing";
    case fs::file_type::regular:
      return "a file";
    case fs::file_type::directory:
      return "a folder";
    case fs::file_type::symlink:
      return LinkAt(path);
    case fs::file_type::fifo:
      return "a pipe";
    case fs::file_type::socket:
      return "a socket";
    case fs::file_type::block:
    case fs::file_type::character:
      return "a device";
    default:
      return fmt::format("something that cannot be looked at ({})", error.message());
  }
}

bool CanReadFile(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

const fs::path& RequireReadable(const fs::path& path) {
  std::error_code ignored;
  RequireNoNul("file", path.native());
  if (CanReadFile(path)) return path;
  if (fs::symlink_status(path, ignored).type() == fs::file_type::not_found)
    ThrowIoError("read", path, ENOENT);
  ThrowNoFile("read", path);
}

void RequireRealFolder(const fs::path& folder) {
  std::error_code error;
  const fs::file_type type = fs::symlink_status(folder, error).type();
  if (type == fs::file_type::directory || type == fs::file_type::not_found) return;
  throw IoError(
      fmt::format("cannot use '{}': it is {}, not a folder, so writes would leave the folder. "
                  "Remove it, or put the folder itself there",
                  folder.string(), WhatIsAt(folder)));
}

void ThrowOpenError(std::string_view action, const fs::path& path, int error) {
  // ELOOP: a link; ENXIO: a pipe or a socket; EISDIR: a folder.
  std::error_code ignored;
  if (fs::is_symlink(fs::symlink_status(path, ignored)) || error == ENXIO || error == EISDIR)
    ThrowNoFile(action, path);
  ThrowIoError(action, path, error);
}

RealFile::RealFile(const fs::path& path, int flags, std::string_view action) {
  const bool reading = (flags & O_ACCMODE) == O_RDONLY;
  if (reading) RequireReadable(path);  // before opening, which may act on a device
  const int links = reading ? 0 : O_NOFOLLOW;
  // O_NONBLOCK: opening a pipe would wait for its other end.
  do {
    descriptor_ = ::open(path.c_str(), flags | links | O_NONBLOCK | O_CLOEXEC, 0644);
  } while (descriptor_ < 0 && errno == EINTR);
  if (descriptor_ < 0) ThrowOpenError(action, path, errno);
  struct stat status = {};
  if (::fstat(descriptor_, &status) == 0 && S_ISREG(status.st_mode)) {
    size_ = static_cast<uint64_t>(status.st_size);
    return;
  }
  ::close(descriptor_);
  ThrowNoFile(action, path);
}

RealFile::~RealFile() { ::close(descriptor_); }

std::string ReadRealFile(const fs::path& path, uint64_t max_bytes) {
  const RealFile file(path, O_RDONLY, "read");
  std::string bytes;
  const auto require = [&](uint64_t size) {
    if (size <= max_bytes) return;
    throw IoError(fmt::format("cannot read '{}': it has {} bytes, {} are the most that is read",
                              path.string(), size, max_bytes));
  };
  require(file.size());
  bytes.reserve(file.size());
  ReadBlocks(file.descriptor(), path, [&](std::string_view block) {
    require(bytes.size() + block.size());  // it may have grown
    bytes += block;
  });
  return bytes;
}

std::string Sha256RealFile(const fs::path& path) {
  const RealFile file(path, O_RDONLY, "read");
  Sha256Stream stream;
  ReadBlocks(file.descriptor(), path, [&](std::string_view block) { stream.Update(block); });
  return stream.Hex();
}

std::string FileIdentity(const fs::path& path) {
  struct stat file;
  if (stat(path.c_str(), &file) != 0) return path.string();
  return fmt::format("{}:{}:{}:{}:{}.{}:{}.{}", path.string(), file.st_dev, file.st_ino,
                     file.st_size, file.st_mtim.tv_sec, file.st_mtim.tv_nsec, file.st_ctim.tv_sec,
                     file.st_ctim.tv_nsec);
}

}  // namespace robocell::internal
