// A dataset's folder: recognises datasets, checks the folders that robocell itself writes into one
// (models, .quarantine, .logs), and moves damaged parts out of the way.
//
// Its own folders must be real folders before they are used: a link in a foreign dataset would lead
// writes out of the dataset.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace robocell {

struct ForeignEntry {
  std::string name;  // within the dataset: "models", ".logs/worker-0.log"
  std::string what;  // "a link to '/etc'"
};

// Lists entries that have the name of one of robocell's own folders, or of a log in it, but are
// something else.
std::vector<ForeignEntry> NotOwn(const std::filesystem::path& dataset);

// Throws IoError that names the first of them, what it is and the next step.
void RequireOwnFolders(const std::filesystem::path& dataset);

// Checks that a folder is a dataset before anything is read from it. For a folder around or within
// a dataset, the error names the dataset.
//
// Throws ArgumentError for a folder that is not a dataset: it has neither a dataset.json nor an
// episode, nor any leftover of these. Throws IoError if it cannot be listed.
void RequireDataset(const std::filesystem::path& folder);

// Moves a part of the dataset ("s0000_e0017", "models/rc7-0123456789abcdef") into its folder
// .quarantine, under a free name, and returns that name: damaged parts are never deleted. Throws
// IoError.
std::string Quarantine(const std::filesystem::path& dataset, const std::string& name);

}  // namespace robocell
