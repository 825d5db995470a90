// Is a folder a dataset? Before anything is read from it, so that one who gave the folder around
// it, or one within it, is told which it is.
#pragma once

#include <filesystem>

namespace robocell {

// ArgumentError for a folder that is no dataset: neither a dataset.json nor an episode, and nothing
// that either leaves behind; it names the dataset that is near. IoError if it cannot be listed.
void RequireDataset(const std::filesystem::path& folder);

}  // namespace robocell
