// Checks that a folder is a dataset before anything is read from it. For a folder around or within
// a dataset, the error names the dataset.
#pragma once

#include <filesystem>

namespace robocell {

// ArgumentError for a folder that is no dataset: neither a dataset.json nor an episode, and nothing
// that either leaves behind; it names the dataset that is near. IoError if it cannot be listed.
void RequireDataset(const std::filesystem::path& folder);

}  // namespace robocell
