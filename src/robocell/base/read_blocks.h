// A file's bytes, piece by piece: its size does not matter.
//
//   ReadBlocks(path, [&](std::string_view block) { hash.Update(block); });
#pragma once

#include <filesystem>
#include <functional>
#include <string_view>

namespace robocell {

// Calls f(bytes) for every block until the end. IoError when the file cannot be read.
void ReadBlocks(const std::filesystem::path& path, const std::function<void(std::string_view)>& f);

// The same of an open file, from where it stands; `path` is for the message.
void ReadBlocks(int descriptor, const std::filesystem::path& path,
                const std::function<void(std::string_view)>& f);

}  // namespace robocell
