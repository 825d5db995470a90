// Private to assets: names below a root folder, environment variables.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace robocell::internal {

// Returns the value of an environment variable, "" if it is not set.
std::string Environment(const char* variable);

// Returns the folder of the user's caches: $XDG_CACHE_HOME, or .cache in $HOME or, without it, in
// the home folder of the system's list of users.
std::filesystem::path UserCacheFolder();

// Returns the file `name` below `root` if it exists. Throws ArgumentError if the name leads out of
// the root (by "..", as an absolute path or through a link).
std::optional<std::filesystem::path> FindBelow(const std::filesystem::path& root,
                                               const std::string& name);

// Throws NotFoundError: "<what> not found. Looked for: a, b. <next step>"
[[noreturn]] void ThrowNotFound(const std::string& what, const std::vector<std::string>& looked,
                                const std::string& next_step);

}  // namespace robocell::internal
