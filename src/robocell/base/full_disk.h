// What to say of a full disk or quota: how much is needed, and how much there is.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace robocell {

// "123 bytes are needed, 45 are free there. Make room and try again."
std::string SpaceHint(const std::filesystem::path& path, std::optional<uint64_t> needed_bytes);

// The words of another library or program, which give no error number; when they tell of a full
// disk and give no such hint, with one: more than `written_bytes` are needed.
std::string WithSpaceHint(std::string said, const std::filesystem::path& path,
                          uint64_t written_bytes);

}  // namespace robocell
