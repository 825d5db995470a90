#include "robocell/testing/menagerie.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <optional>

#include "robocell/assets/resolve.h"
#include "robocell/base/error.h"
#include "robocell/testing/source_dir.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;

std::string Environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

fs::path SharedRoot() { return fs::path(SourceDir()).parent_path() / "shared" / "menagerie"; }

// Makes ../shared/menagerie the root of this process by default.
void AdoptSharedRoot() {
  static std::once_flag once;
  std::call_once(once, [] {
    if (Environment("MENAGERIE_ROOT").empty() && fs::is_directory(SharedRoot())) {
      setenv("MENAGERIE_ROOT", SharedRoot().c_str(), 1);
    }
  });
}

std::optional<fs::path> FindModel(std::string_view model) {
  AdoptSharedRoot();
  try {
    return menagerie::RobotFolder(std::string(model));
  } catch (const NotFoundError&) {
    return std::nullopt;
  }
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
  std::string places;
  try {
    menagerie::RobotFolder(missing.front());
  } catch (const NotFoundError& error) {
    places = error.what();
  }
  return fmt::format("Menagerie models missing: {}. Fetch them: robocell fetch {}\n{}",
                     fmt::join(missing, ", "), fmt::join(missing, " "), places);
}

}  // namespace robocell
