#include "robocell/assets/roots.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdlib>

#include "robocell/base/error.h"
#include "robocell/base/paths.h"

namespace robocell::internal {

namespace fs = std::filesystem;

std::string Environment(const char* variable) {
  const char* value = std::getenv(variable);
  return value ? value : "";
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
