#include "robocell/testing/menagerie.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <optional>

#include "robocell/base/error.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;

std::string Environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

fs::path SharedRoot() {
  return fs::path(ROBOCELL_SOURCE_DIR).parent_path() / "shared" / "menagerie";
}

// Makes ../shared/menagerie the root of this process when nothing else was said.
void AdoptSharedRoot() {
  static std::once_flag once;
  std::call_once(once, [] {
    if (Environment("MENAGERIE_ROOT").empty() && fs::is_directory(SharedRoot())) {
      setenv("MENAGERIE_ROOT", SharedRoot().c_str(), 1);
    }
  });
}

// The package's own rule, see mujoco_menagerie/_cache.py.
fs::path CacheModels() {
  if (std::string dir = Environment("MENAGERIE_CACHE_DIR"); !dir.empty()) {
    return fs::path(dir) / "models";
  }
  std::string cache = Environment("XDG_CACHE_HOME");
  if (cache.empty()) cache = Environment("HOME") + "/.cache";
  return fs::path(cache) / "mujoco_menagerie" / "models";
}

// A cached model is <name>-<16 hex digits of its content>, complete once it holds `.complete`.
std::optional<fs::path> FindInCache(std::string_view model) {
  std::vector<fs::path> found;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(CacheModels(), ignored)) {
    const std::string folder = entry.path().filename();
    const size_t dash = folder.rfind('-');
    if (dash != std::string::npos && folder.substr(0, dash) == model &&
        fs::exists(entry.path() / ".complete")) {
      found.push_back(entry.path());
    }
  }
  if (found.empty()) return std::nullopt;
  return *std::max_element(found.begin(), found.end());
}

std::optional<fs::path> FindModel(std::string_view model) {
  AdoptSharedRoot();
  if (const std::string root = Environment("MENAGERIE_ROOT"); !root.empty()) {
    const fs::path folder = fs::path(root) / model;
    if (fs::is_directory(folder)) return folder;
    return std::nullopt;
  }
  return FindInCache(model);
}

}  // namespace

const std::vector<std::string>& MenagerieTestModels() {
  static const std::vector<std::string> models = {"ufactory_xarm7", "kinova_gen3", "robotiq_2f85",
                                                  "franka_fr3", "franka_emika_panda"};
  return models;
}

std::string MenagerieModel(std::string_view model, std::string_view file) {
  const std::optional<fs::path> folder = FindModel(model);
  if (!folder) throw IoError(MissingMenagerie({std::string(model)}));
  const fs::path path = file.empty() ? *folder : *folder / file;
  if (!fs::exists(path)) throw IoError(fmt::format("no '{}' in {}", file, folder->string()));
  return path.string();
}

std::string MissingMenagerie(const std::vector<std::string>& models) {
  std::vector<std::string> missing;
  for (const std::string& model : models.empty() ? MenagerieTestModels() : models) {
    if (!FindModel(model)) missing.push_back(model);
  }
  if (missing.empty()) return "";
  const std::string root = Environment("MENAGERIE_ROOT");
  const std::string looked =
      root.empty() ? fmt::format("MENAGERIE_ROOT is not set, {} is not there, and {} lacks them",
                                 SharedRoot().string(), CacheModels().string())
                   : fmt::format("MENAGERIE_ROOT={} lacks them", root);
  return fmt::format(
      "Menagerie models missing: {}. Looked: {}. Fetch them: mujoco-menagerie prefetch {}",
      fmt::join(missing, ", "), looked, fmt::join(missing, " "));
}

}  // namespace robocell
