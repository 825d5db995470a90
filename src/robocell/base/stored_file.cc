#include "robocell/base/stored_file.h"

#include <fcntl.h>
#include <unistd.h>
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <memory>
#include <system_error>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/hash.h"
#include "robocell/base/io_error.h"

namespace robocell {

namespace fs = std::filesystem;

namespace internal {
namespace {

constexpr size_t kBlock = size_t{1} << 20;

void ReadPart(const FilePart& part, const std::function<void(std::string_view)>& f) {
  ReadRange(part.shard, part.begin, part.bytes, f);
}

}  // namespace

std::string WhatIsStoredAt(const fs::path& path) {
  if (const auto part = PartAt(path)) return WhatIsAt(part->shard);
  return WhatIsAt(path);
}

bool CanReadStoredFile(const fs::path& path) {
  if (const auto part = PartAt(path)) return CanReadFile(part->shard);
  return CanReadFile(path);
}

const fs::path& RequireStoredFile(const fs::path& path) {
  const auto part = PartAt(path);
  RequireReadable(part ? part->shard : path);
  return path;
}

uint64_t StoredFileBytes(const fs::path& path) {
  const auto part = PartAt(path);
  std::error_code error;
  const uint64_t bytes = fs::file_size(part ? part->shard : path, error);
  if (error) ThrowIoError("look at", part ? part->shard : path, error.value());
  if (!part) return bytes;
  return std::min(part->bytes, bytes - std::min(bytes, part->begin));
}

std::string StoredFileIdentity(const fs::path& path) {
  const auto part = PartAt(path);
  if (!part) return FileIdentity(path);
  return fmt::format("{}:{}:{}:{}", path.string(), FileIdentity(part->shard), part->begin,
                     part->bytes);
}

std::string ReadStoredFile(const fs::path& path, uint64_t max_bytes) {
  const auto part = PartAt(path);
  if (!part) return ReadRealFile(path, max_bytes);
  if (part->bytes > max_bytes) {
    throw IoError(fmt::format("cannot read '{}': it has {} bytes, {} are the most that is read",
                              path.string(), part->bytes, max_bytes));
  }
  std::string bytes;
  bytes.reserve(part->bytes);
  ReadPart(*part, [&](std::string_view block) { bytes += block; });
  return bytes;
}

std::string Sha256StoredFile(const fs::path& path) {
  const auto part = PartAt(path);
  if (!part) return Sha256RealFile(path);
  Sha256Stream stream;
  ReadPart(*part, [&](std::string_view block) { stream.Update(block); });
  return stream.Hex();
}

std::vector<std::string> StoredNames(const fs::path& folder) {
  const auto index = PackedIndexOf(folder.parent_path());
  const std::string id = folder.filename().string();
  return index && index->Contains(id) ? index->FilesOf(id) : FolderNames(folder);
}

void ReadRange(const fs::path& path, uint64_t begin, uint64_t count,
               const std::function<void(std::string_view)>& f) {
  const RealFile file(path, O_RDONLY, "read");
  std::string block(std::min<uint64_t>(count, kBlock), '\0');
  while (count > 0) {
    const ssize_t read =
        ::pread(file.descriptor(), block.data(), std::min<uint64_t>(count, block.size()),
                static_cast<off_t>(begin));
    if (read < 0 && errno == EINTR) continue;
    if (read < 0) ThrowIoError("read", path, errno);
    if (read == 0) {
      throw IoError(fmt::format("'{}' is cut short: it ends at byte {}, {} more are missing",
                                path.string(), begin, count));
    }
    f(std::string_view(block).substr(0, static_cast<size_t>(read)));
    begin += static_cast<uint64_t>(read);
    count -= static_cast<uint64_t>(read);
  }
}

}  // namespace internal

std::optional<internal::FilePart> PartAt(const fs::path& path) {
  const std::shared_ptr<const internal::PackedIndex> index = internal::IndexAround(path);
  if (!index) return std::nullopt;
  const auto found =
      index->parts.find((path.parent_path().filename() / path.filename()).generic_string());
  if (found == index->parts.end()) return std::nullopt;
  return found->second;
}

std::string FfmpegInput(const fs::path& path) {
  const auto part = PartAt(path);
  if (!part) return "file:" + path.string();
  return fmt::format("subfile,,start,{},end,{},,:{}", part->begin, part->begin + part->bytes,
                     "file:" + part->shard.string());
}

}  // namespace robocell
