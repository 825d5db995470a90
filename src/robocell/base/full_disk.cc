#include "robocell/base/full_disk.h"

#include <cerrno>
#include <system_error>

#include <fmt/format.h>

#include "robocell/base/error.h"
#include "robocell/base/io_error.h"

namespace robocell {
namespace {

constexpr std::string_view kHintEnd = "free there. Make room and try again.";

bool TellsOfFullDisk(std::string_view said) {
  for (const int error : {ENOSPC, EDQUOT}) {
    if (said.find(std::generic_category().message(error)) != std::string_view::npos) return true;
  }
  return false;
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
  if (!TellsOfFullDisk(said) || said.find(kHintEnd) != std::string::npos) return said;
  return fmt::format("{}. More than {}", said, SpaceHint(path, written_bytes));
}

}  // namespace robocell
