#include "robocell/base/io_error.h"

#include <cerrno>
#include <system_error>

#include <fmt/format.h>

#include "robocell/base/error.h"

namespace robocell {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kHintEnd = "free there. Make room and try again.";

bool NamesError(int error, std::string_view message) {
  return message.find(std::generic_category().message(error)) != std::string_view::npos;
}

// Removes ". 12 bytes are needed, 0 are free there. Make room and try again.".
void CutHint(std::string& message) {
  const size_t end = message.find(kHintEnd);
  if (end == std::string::npos) return;
  const size_t begin = message.rfind(". ", end);
  if (begin != std::string::npos) message.erase(begin, end + kHintEnd.size() - begin);
}

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

std::string SpaceHint(const fs::path& path, std::optional<uint64_t> needed_bytes) {
  std::string free = "an unknown number of";
  try {
    free = std::to_string(FreeBytes(path));
  } catch (const IoError&) {
  }
  if (!needed_bytes) return fmt::format("{} bytes are {}", free, kHintEnd);
  return fmt::format("{} bytes are needed, {} are {}", *needed_bytes, free, kHintEnd);
}

std::string WithSpaceHint(std::string message, const fs::path& path, uint64_t written_bytes) {
  const bool of_quota = NamesError(EDQUOT, message);
  if (!of_quota && !NamesError(ENOSPC, message)) return message;
  CutHint(message);
  if (of_quota)
    return fmt::format(
        "{}. More than {} bytes are needed, and the quota leaves less. Make room and try again.",
        message, written_bytes);
  uint64_t room = written_bytes;
  try {
    room += FreeBytes(path);
  } catch (const IoError&) {
  }
  return fmt::format("{}. More than {} bytes are needed, {} are {}", message, room, room, kHintEnd);
}

}  // namespace robocell
