// A dataset's folder: whether a folder is one, the folders that robocell itself writes into it
// (models, .quarantine, .logs), and moving what is damaged out of the way.
//
// Its own folders must be real ones before they are used: a link in a dataset from elsewhere would
// lead what is written out of it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace robocell {

struct ForeignThing {
  std::string name;  // within the dataset: "models", ".logs/worker-0.log"
  std::string what;  // "a link to '/etc'"
};

// Lists entries that have the name of one of robocell's own folders, or of a log in it, but are
// something else.
std::vector<ForeignThing> NotOwn(const std::filesystem::path& dataset);

// IoError names the first of them, what it is and the next step.
void RequireOwnFolders(const std::filesystem::path& dataset);

// Checks that a folder is a dataset before anything is read from it. For a folder around or within
// a dataset, the error names the dataset.
//
// ArgumentError for a folder that is no dataset: neither a dataset.json nor an episode, and nothing
// that either leaves behind; it names the dataset that is near. IoError if it cannot be listed.
void RequireDataset(const std::filesystem::path& folder);

// Moves something of the dataset ("s0000_e0017", "models/rc7-0123456789abcdef") into its folder
// .quarantine, under a name that is free there, and returns that name: nothing that is damaged is
// deleted. IoError.
std::string Quarantine(const std::filesystem::path& dataset, const std::string& name);

}  // namespace robocell
