// Opens files and folders from others, such as a foreign dataset, only if they are real files and
// folders. A pipe or device never ends, a file may be larger than the memory, and writing through a
// link changes another file.
//
//   const std::string text = ReadRealFile(dataset / "dataset.json");  // IoError for a pipe
//   RequireRealFolder(dataset / "models");                            // before writing into it
//
// A link to a file is read as that file (download caches consist of such links; see
// docs/decisions/008-read-through-links-never-write.md), and never written through; a folder is
// never a link. Links in the folders before the last name are followed: the user chooses the
// dataset's place. The IoError contains the path, what is at it, and what to do. Any thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace robocell::internal {

// Returns "nothing", "a file", "a folder", "a link to '/etc/passwd'", "a pipe", "a socket", "a
// device".
std::string WhatIsAt(const std::filesystem::path& path);
// Returns true if the path is a file, or a link to one.
bool CanReadFile(const std::filesystem::path& path);
// Returns the path. Throws IoError with what it is instead of a file.
const std::filesystem::path& RequireReadable(const std::filesystem::path& path);

// The folder may also be missing.
void RequireRealFolder(const std::filesystem::path& folder);

// Throws the reason why open(2) failed; `error` is its errno.
[[noreturn]] void ThrowOpenError(std::string_view action, const std::filesystem::path& path,
                                 int error);

// Returns the identity of a file: its path, device, inode, size and times. A file that was written
// or replaced has another identity. Without a file it is the path alone.
std::string FileIdentity(const std::filesystem::path& path);

// An open regular file.
class RealFile {
 public:
  // `flags` are those of open(2): links are followed with O_RDONLY only. `action` is a verb for the
  // message: "read".
  RealFile(const std::filesystem::path& path, int flags, std::string_view action);
  ~RealFile();
  RealFile(const RealFile&) = delete;
  RealFile& operator=(const RealFile&) = delete;

  int descriptor() const { return descriptor_; }
  uint64_t size() const { return size_; }

 private:
  int descriptor_ = -1;
  uint64_t size_ = 0;
};

// Descriptions are kilobytes.
inline constexpr uint64_t kMaxDescriptionBytes = uint64_t{64} << 20;

// Returns the whole content. Throws IoError if it is longer than `max_bytes`.
std::string ReadRealFile(const std::filesystem::path& path,
                         uint64_t max_bytes = kMaxDescriptionBytes);

// Like Sha256File (hash.h).
std::string Sha256RealFile(const std::filesystem::path& path);

}  // namespace robocell::internal
