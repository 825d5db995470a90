// The folders that robocell itself writes into a dataset: models, .quarantine, .logs. They must be
// real ones before they are used: a link in a dataset from elsewhere would lead what is written out
// of it. Internal to data/.
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

}  // namespace robocell
