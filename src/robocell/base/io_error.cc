#include "robocell/base/io_error.h"

#include <cerrno>
#include <system_error>

#include <fmt/format.h>

#include "robocell/base/error.h"
#include "robocell/base/full_disk.h"

namespace robocell {
namespace fs = std::filesystem;
namespace {

std::string Hint(const fs::path& path, int error, std::optional<uint64_t> needed_bytes) {
  switch (error) {
    case ENOSPC:
    case EDQUOT:
      return SpaceHint(path, needed_bytes);
    case EROFS:
    case EACCES:
    case EPERM:
      return "Choose another place or ask for permission to use this one.";
    case EMFILE:
    case ENFILE:
      return "Too many files are open at once: raise the limit (ulimit -n).";
    default:
      return "";
  }
}

}  // namespace

void ThrowIoError(std::string_view action, const fs::path& path, int error,
                  std::optional<uint64_t> needed_bytes) {
  const std::string hint = Hint(path, error, needed_bytes);
  throw IoError(fmt::format("cannot {} '{}': {}{}{}", action, path.native(),
                            std::generic_category().message(error), hint.empty() ? "" : ". ", hint),
                error);
}

uint64_t FreeBytes(const fs::path& path) {
  std::error_code error;
  fs::path existing = fs::absolute(path, error);
  while (!error && !fs::exists(existing, error) && existing.has_relative_path()) {
    existing = existing.parent_path();
    error.clear();
  }
  const fs::space_info space = fs::space(existing, error);
  if (error) ThrowIoError("ask for the free space of", path, error.value());
  return space.available;
}

}  // namespace robocell
