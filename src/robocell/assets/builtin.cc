// The built-in models.
#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <vector>

#include "robocell/assets/resolve.h"
#include "robocell/assets/roots.h"
#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/log.h"
#include "robocell/base/suggestions.h"

namespace robocell::assets {
namespace {

namespace fs = std::filesystem;

bool HoldsModels(const fs::path& folder) {
  std::error_code error;
  return fs::is_directory(folder / "robots", error);
}

// Returns the folder of the robocell library.
fs::path LibraryFolder() {
  Dl_info info;
  std::error_code error;
  if (!dladdr(reinterpret_cast<const void*>(&ModelsRoot), &info)) return fs::current_path(error);
  return fs::weakly_canonical(info.dli_fname, error).parent_path();
}

// Returns the models beside the library.
fs::path InstalledModels() {
  const fs::path library = LibraryFolder();
  std::vector<std::string> looked;
  for (const char* place : {"models", "../share/robocell/models", "../../share/robocell/models"}) {
    const fs::path folder = (library / place).lexically_normal();
    // In a build folder it is a link: cells are found beside the models themselves.
    if (HoldsModels(folder)) return fs::canonical(folder);
    looked.push_back(folder.string());
  }
  internal::ThrowNotFound("the folder of built-in models", looked, "Set ROBOCELL_MODELS to it.");
}

fs::path FindModelsRoot() {
  if (const std::string root = internal::Environment("ROBOCELL_MODELS"); !root.empty()) {
    if (HoldsModels(root)) return root;
    throw NotFoundError(fmt::format("ROBOCELL_MODELS is {}, which has no folder `robots`", root));
  }
  // The check of a run asks hundreds of times, and links are slow to follow.
  static const fs::path known = InstalledModels();
  return HoldsModels(known) ? known : InstalledModels();
}

// Returns true for a name that a folder can have: not for paths.
bool IsFolderName(const std::string& name) {
  return !name.empty() && name != "." && name != ".." && name.find('/') == std::string::npos;
}

// Returns true if there is a file root/name/name.xml.
bool HasModel(const fs::path& root, const std::string& name) {
  std::error_code error;  // set by a circle of links
  return IsFolderName(name) && fs::exists(root / name / (name + ".xml"), error);
}

// Returns the names N of root/N/N.xml.
std::vector<std::string> ModelsBelow(const fs::path& root) {
  std::vector<std::string> names;
  for (const std::string& name : FolderNamesIfAny(root)) {
    if (HasModel(root, name)) names.push_back(name);
  }
  return names;
}

// Warns once in this process.
void WarnOfTakenName(const std::string& folder, const std::string& name) {
  static std::mutex mutex;
  static std::set<std::string> warned;
  {
    const std::lock_guard lock(mutex);
    if (!warned.insert(folder).second) return;
  }
  LogWarn(
      fmt::format("{} is no object for tasks: '{}' is a built-in model that is no object. "
                  "Rename the folder and its model",
                  folder, name));
}

std::vector<std::string> ModelsWithFolder(const char* kind) {
  return ModelsBelow(fs::path(ModelsRoot()) / kind);
}

fs::path CellsFolder() {
  return (fs::path(ModelsRoot()) / ".." / "examples" / "envs").lexically_normal();
}

// Returns the names N of folder/N<ending>.
std::vector<std::string> FilesWith(const char* ending, const fs::path& folder) {
  std::vector<std::string> names;
  for (const std::string& file : FolderNamesIfAny(folder)) {
    if (fs::path(file).extension() == ending) names.push_back(fs::path(file).stem().string());
  }
  return names;
}

}  // namespace

std::string ModelsRoot() { return FindModelsRoot().string(); }

std::vector<std::string> BuiltinRobots() { return ModelsWithFolder("robots"); }

std::vector<std::string> BuiltinObjects() { return ModelsWithFolder("objects"); }

std::vector<std::string> BuiltinEquipment() { return ModelsWithFolder("equipment"); }

std::vector<std::string> BuiltinScenes() {
  return FilesWith(".xml", fs::path(ModelsRoot()) / "scenes");
}

std::vector<std::string> BuiltinModels() {
  std::vector<std::string> names = BuiltinRobots();
  for (const auto& more : {BuiltinObjects(), BuiltinEquipment(), BuiltinScenes()})
    names.insert(names.end(), more.begin(), more.end());
  std::sort(names.begin(), names.end());
  return names;
}

std::map<std::string, std::string> ObjectFolders() {
  std::map<std::string, std::string> folders;
  const std::string built_in = ModelsRoot();
  std::vector<std::string> roots = ModelPathRoots();
  roots.push_back(built_in);
  for (const std::string& root : roots) {
    const fs::path objects = fs::path(root) / "objects";
    for (const std::string& name : ModelsBelow(objects)) {
      if (root != built_in && IsBuiltinOtherThanObject(name)) {
        WarnOfTakenName((objects / name).string(), name);
      } else {
        folders.emplace(name, (objects / name).string());
      }
    }
  }
  return folders;
}

std::optional<std::string> ObjectFolder(const std::string& name) {
  if (!IsBuiltinOtherThanObject(name)) {
    for (const std::string& root : ModelPathRoots()) {
      const fs::path objects = fs::path(root) / "objects";
      if (HasModel(objects, name)) return (objects / name).string();
    }
  }
  const fs::path objects = fs::path(ModelsRoot()) / "objects";
  if (HasModel(objects, name)) return (objects / name).string();
  return std::nullopt;
}

bool IsBuiltinOtherThanObject(const std::string& name) {
  std::error_code error;
  const fs::path root = ModelsRoot();
  return IsFolderName(name) &&
         (HasModel(root / "robots", name) || HasModel(root / "equipment", name) ||
          fs::exists(root / "scenes" / (name + ".xml"), error));
}

std::string BuiltinRobotFile(const std::string& name) {
  if (const auto file =
          internal::FindBelow(fs::path(ModelsRoot()) / "robots", name + "/" + name + ".yaml")) {
    return file->string();
  }
  throw NotFoundError(NoSuchName("built-in models", "robot", name, BuiltinRobots()));
}

std::vector<std::string> BuiltinCells() { return FilesWith(".yaml", CellsFolder()); }

std::string BuiltinCellFile(const std::string& name) {
  if (const auto file = internal::FindBelow(CellsFolder(), name + ".yaml")) return file->string();
  throw NotFoundError(NoSuchName("ready-made environments", "cell", name, BuiltinCells()));
}

}  // namespace robocell::assets
