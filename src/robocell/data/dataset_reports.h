// The reports in a dataset (report.json): the episodes that they list and that are lost, and the
// runs that they belong to.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace robocell {

// Returns lost episodes, for example after an incomplete copy or a removed folder: ids that an
// undamaged report of the dataset (report.json, report-0-of-2.json) lists as successes, and that
// are neither in the dataset, in any state, nor in its .quarantine; sorted.
std::vector<std::string> LostEpisodes(const std::filesystem::path& dataset);

// Returns `houses` of the undamaged report whose last command ended last: the numbers of the scenes
// that the run takes, empty for all. Unset if no report says.
std::optional<std::vector<int>> HousesOfReports(const std::filesystem::path& dataset);

// `robocell report` and verify rely on reports, which are easily copied.
//
// Returns the name of the run that a report (its text) belongs to if it is not the run of
// dataset.json. Unset if it is the same, or unknown: without a readable dataset.json, or without an
// identity.
std::optional<std::string> OtherRunOf(const std::string& report,
                                      const std::filesystem::path& dataset);

}  // namespace robocell
