// Whose report is it that lies in a dataset? Reports are believed by `robocell report` and verify,
// and are easily copied.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace robocell {

// The name of the run that a report (its text) is of, when that is another one than dataset.json
// describes. Unset when it is the same, or nothing says so: no readable dataset.json, no identity.
std::optional<std::string> OtherRunOf(const std::string& report,
                                      const std::filesystem::path& dataset);

}  // namespace robocell
