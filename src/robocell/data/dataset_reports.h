// What the reports in a dataset say (report.json): the episodes that they acknowledged and that are
// gone, and whose reports they are.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace robocell {

// Episodes that are gone, by an incomplete copy or a removed folder: ids that an undamaged report of the dataset (report.json, report-0-of-2.json) gives as successes,
// and that are neither in the dataset, whatever their state, nor in its .quarantine; sorted.
std::vector<std::string> LostEpisodes(const std::filesystem::path& dataset);

// `robocell report` and verify believe reports, which are easily copied.
//
// The name of the run that a report (its text) is of, when that is another one than dataset.json
// describes. Unset when it is the same, or nothing says so: no readable dataset.json, no identity.
std::optional<std::string> OtherRunOf(const std::string& report,
                                      const std::filesystem::path& dataset);

}  // namespace robocell
