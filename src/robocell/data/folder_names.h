// What a folder holds, for telling about it and going through it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace robocell {

// Names without the folder, sorted. IoError when it cannot be listed to the end.
std::vector<std::string> FolderNames(const std::filesystem::path& folder);

}  // namespace robocell
