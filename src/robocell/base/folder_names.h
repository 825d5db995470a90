// Lists the entries of a folder, for messages and for iteration.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace robocell {

// Names without the folder, sorted. IoError when it cannot be listed to the end.
std::vector<std::string> FolderNames(const std::filesystem::path& folder);

// The same as far as it can be listed, none where there is no folder: for hints in messages, and
// for places that may be there.
std::vector<std::string> FolderNamesIfAny(const std::filesystem::path& folder);

}  // namespace robocell
