// Private to assets: names below a root folder, environment variables.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace robocell::internal {

// Returns the value of an environment variable, "" if it is not set.
std::string Environment(const char* variable);

// Returns the file `name` below `root` if it exists. Throws ArgumentError if the name leads out of
// the root (by "..", as an absolute path or through a link).
std::optional<std::filesystem::path> FindBelow(const std::filesystem::path& root,
                                               const std::string& name);

// Throws NotFoundError: "<what> not found. Looked for: a, b. <next step>"
[[noreturn]] void ThrowNotFound(const std::string& what, const std::vector<std::string>& looked,
                                const std::string& next_step);

}  // namespace robocell::internal
