// Stored models that are not those which the dataset's run was begun with: their files were changed
// while it was made, or they came with episodes of another dataset. dataset.json has the hashes of
// all files of the run's models (`files`).
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace robocell {

// Folder of the model in the dataset ("models/rc7-0123456789abcdef") -> the file that differs
// ("rc7.xml"). A file is known by its name and what it holds; where the run's models lay says
// nothing. Models that the run does not list, of a sampler of the user's own, are in order. Empty
// without a readable dataset.json.
std::map<std::string, std::string> ChangedModels(const std::filesystem::path& dataset);

// Whether a stored model ("models/rc7-0123456789abcdef/rc7.xml") exists and has exactly the files
// that dataset.json lists. False without a readable dataset.json.
bool IsModelOfRun(const std::filesystem::path& dataset, const std::string& path);

}  // namespace robocell
