#include "robocell/assets/portable_name.h"

#include <filesystem>
#include <vector>

#include "robocell/assets/override.h"
#include "robocell/assets/resolve.h"
#include "robocell/assets/roots.h"
#include "robocell/base/error.h"

namespace robocell::assets {
namespace {

namespace fs = std::filesystem;

constexpr size_t kVersionLength = 17;  // "-" and 16 digits: the Menagerie's folders in its cache

bool Means(const std::string& name, const fs::path& path) {
  if (!Environment(OverrideVariable(name).c_str()).empty()) return false;  // here only
  try {
    std::error_code error;
    return fs::equivalent(Resolve(name), path, error);
  } catch (const Error&) {
    return false;
  }
}

// The names that the file would have as a built-in model or one of the Menagerie.
std::vector<std::string> Candidates(const fs::path& path) {
  const std::string robot = path.parent_path().filename().string();
  const std::string file = path.filename().string();
  std::vector<std::string> names = {path.stem().string(), "menagerie:" + robot + "/" + file};
  if (robot.size() > kVersionLength)
    names.push_back("menagerie:" + robot.substr(0, robot.size() - kVersionLength) + "/" + file);
  return names;
}

}  // namespace

std::optional<std::string> PortableName(const std::string& path) {
  for (const std::string& name : Candidates(path)) {
    if (Means(name, path)) return name;
  }
  return std::nullopt;
}

}  // namespace robocell::assets
