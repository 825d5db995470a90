// Texts of failed file operations: what was tried, where, the system's reason, what to do about it;
// of a full disk or quota how much is needed, and how much there is.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace robocell {

// Throws IoError "cannot <action> '<path>': <reason>" with a hint for the usual reasons. `error` is
// an errno; for a full disk or quota the message says how many bytes are needed (when
// `needed_bytes` is given) and how many are free there.
//
//   if (::rename(a, b) != 0) ThrowIoError("rename", a, errno);
[[noreturn]] void ThrowIoError(std::string_view action, const std::filesystem::path& path,
                               int error, std::optional<uint64_t> needed_bytes = std::nullopt);

// Bytes that may still be written on the file system of `path`, or of its nearest existing parent.
uint64_t FreeBytes(const std::filesystem::path& path);

// "123 bytes are needed, 45 are free there. Make room and try again."
std::string SpaceHint(const std::filesystem::path& path, std::optional<uint64_t> needed_bytes);

// Adds a hint to the message about a value that is written bit by bit, while the part already
// written still takes up `written_bytes`. For a full disk the hint says that more is needed than
// without that part. A hint about the last bit is left out.
std::string WithSpaceHint(std::string said, const std::filesystem::path& path,
                          uint64_t written_bytes);

}  // namespace robocell
