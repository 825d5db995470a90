#include "robocell/base/full_disk.h"

#include <cerrno>
#include <system_error>

#include <fmt/format.h>

#include "robocell/base/error.h"
#include "robocell/base/io_error.h"

namespace robocell {
namespace {

constexpr std::string_view kHintEnd = "free there. Make room and try again.";

bool TellsOf(int error, std::string_view said) {
  return said.find(std::generic_category().message(error)) != std::string_view::npos;
}

// ". 12 bytes are needed, 0 are free there. Make room and try again."
void CutHint(std::string& said) {
  const size_t end = said.find(kHintEnd);
  if (end == std::string::npos) return;
  const size_t begin = said.rfind(". ", end);
  if (begin != std::string::npos) said.erase(begin, end + kHintEnd.size() - begin);
}

}  // namespace

std::string SpaceHint(const std::filesystem::path& path, std::optional<uint64_t> needed_bytes) {
  std::string free = "an unknown number of";
  try {
    free = std::to_string(FreeBytes(path));
  } catch (const IoError&) {
  }
  if (!needed_bytes) return fmt::format("{} bytes are {}", free, kHintEnd);
  return fmt::format("{} bytes are needed, {} are {}", *needed_bytes, free, kHintEnd);
}

std::string WithSpaceHint(std::string said, const std::filesystem::path& path,
                          uint64_t written_bytes) {
  const bool of_quota = TellsOf(EDQUOT, said);
  if (!of_quota && !TellsOf(ENOSPC, said)) return said;
  CutHint(said);
  if (of_quota)
    return fmt::format(
        "{}. More than {} bytes are needed, and the quota leaves less. Make room and try again.",
        said, written_bytes);
  uint64_t room = written_bytes;
  try {
    room += FreeBytes(path);
  } catch (const IoError&) {
  }
  return fmt::format("{}. More than {} bytes are needed, {} are {}", said, room, room, kHintEnd);
}

}  // namespace robocell
