// Folders that a power cut does not take away again.
#pragma once

#include <filesystem>
#include <string_view>

namespace robocell::internal {

// Creates a folder and the missing ones above it, and flushes the folders that they are entries of:
// a durable file below a new folder is lost with the folder's own entry. Folders that cannot be
// read are not flushed. An existing folder is left as it is. `what` is the message's name for it:
// "the dataset's folder". Throws IoError.
void MakeDirectories(const std::filesystem::path& path, std::string_view what = "the folder");

}  // namespace robocell::internal
