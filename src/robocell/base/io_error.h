// Texts of failed file operations: the action, the path, the system's reason, and the next step;
// for a full disk or quota also the needed and the free space.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace robocell {

// Throws IoError "cannot <action> '<path>': <reason>" with a hint for the usual reasons. `error` is
// an errno; for a full disk or quota the message contains the needed bytes (if `needed_bytes` is
// given) and the free ones.
//
//   if (::rename(a, b) != 0) ThrowIoError("rename", a, errno);
[[noreturn]] void ThrowIoError(std::string_view action, const std::filesystem::path& path,
                               int error, std::optional<uint64_t> needed_bytes = std::nullopt);

// Returns the bytes that may still be written on the file system of `path`, or of its nearest
// existing parent.
uint64_t FreeBytes(const std::filesystem::path& path);

// Returns "123 bytes are needed, 45 are free there. Make room and try again.".
std::string SpaceHint(const std::filesystem::path& path, std::optional<uint64_t> needed_bytes);

// Adds a hint to the message about a file that is written in parts, while the written part still
// takes up `written_bytes`. For a full disk the hint adds these to the needed bytes. A hint about
// the last part is left out.
std::string WithSpaceHint(std::string message, const std::filesystem::path& path,
                          uint64_t written_bytes);

}  // namespace robocell
