#include "robocell/assets/roots.h"

#include <pwd.h>
#include <unistd.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cstdlib>

#include "robocell/base/error.h"
#include "robocell/base/paths.h"

namespace robocell::internal {

namespace fs = std::filesystem;

std::string Environment(const char* variable) {
  const char* value = std::getenv(variable);
  return value ? value : "";
}

fs::path UserCacheFolder() {
  if (const std::string cache = Environment("XDG_CACHE_HOME"); !cache.empty()) return cache;
  if (const std::string home = Environment("HOME"); !home.empty()) return fs::path(home) / ".cache";
  passwd entry = {};
  passwd* found = nullptr;
  std::array<char, 4096> text = {};
  ::getpwuid_r(::getuid(), &entry, text.data(), text.size(), &found);
  return fs::path(found ? found->pw_dir : "/") / ".cache";
}

std::optional<fs::path> FindBelow(const fs::path& root, const std::string& name) {
  std::error_code error;
  const fs::path path = fs::absolute(ConfinedPath(root, name), error).lexically_normal();
  if (!fs::is_regular_file(path, error)) return std::nullopt;
  return path;
}

void ThrowNotFound(const std::string& what, const std::vector<std::string>& looked,
                   const std::string& next_step) {
  throw NotFoundError(fmt::format("{} not found. Looked for: {}.{}{}", what,
                                  fmt::join(looked, ", "), next_step.empty() ? "" : " ",
                                  next_step));
}

}  // namespace robocell::internal
