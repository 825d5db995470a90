// Finds acknowledged episodes that are gone: an incomplete copy, a removed folder.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace robocell {

// Ids that an undamaged report of the dataset (report.json, report-0-of-2.json) gives as successes,
// and that are neither in the dataset, whatever their state, nor in its .quarantine; sorted.
std::vector<std::string> LostEpisodes(const std::filesystem::path& dataset);

}  // namespace robocell
