// Private to assets: names below a root folder, environment variables.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace robocell::internal {

// The value of an environment variable, "" when it is not set.
std::string Environment(const char* variable);

// The file `name` below `root` when there is one. ArgumentError when the name leads out of the root
// (by "..", as an absolute path or through a link).
std::optional<std::filesystem::path> FindBelow(const std::filesystem::path& root,
                                               const std::string& name);

// NotFoundError: "<what> not found. Looked for: a, b. <next step>"
[[noreturn]] void ThrowNotFound(const std::string& what, const std::vector<std::string>& looked,
                                const std::string& next_step);

}  // namespace robocell::internal
