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

// What somebody said of a thing that is written bit by bit, while the part of it that is there
// still takes up `written_bytes`. When it tells of a full disk, with one hint: more is needed than
// there is without that part. A hint about the last bit is left out.
std::string WithSpaceHint(std::string said, const std::filesystem::path& path,
                          uint64_t written_bytes);

}  // namespace robocell
