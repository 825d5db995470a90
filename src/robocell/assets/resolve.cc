#include "robocell/assets/resolve.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <string_view>
#include <vector>

#include "robocell/assets/roots.h"
#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/paths.h"
#include "robocell/base/real_file.h"
#include "robocell/base/suggestions.h"

namespace robocell::assets {
namespace {

namespace fs = std::filesystem;
constexpr std::string_view kMenagerie = "menagerie:";

// Looks in one place after the other and records them for the message.
class Search {
 public:
  bool TryFile(const fs::path& path) {
    std::error_code error;
    const std::string full = fs::absolute(path, error).lexically_normal().string();
    if (internal::CanReadFile(path)) return found_ = full, true;
    const bool other = fs::exists(path, error);
    return looked_.push_back(other ? full + " (" + internal::WhatIsAt(path) + ")" : full), false;
  }
  bool TryBelow(const fs::path& root, const std::string& name) {
    if (const auto path = internal::FindBelow(root, name)) return found_ = path->string(), true;
    return looked_.push_back((root / name).string()), false;
  }
  const std::string& found() const { return found_; }
  const std::vector<std::string>& looked() const { return looked_; }

 private:
  std::string found_;
  std::vector<std::string> looked_;
};

bool IsModelFile(const fs::path& name) {
  return name.extension() == ".xml" || name.extension() == ".urdf";
}

bool IsPlainName(const std::string& name) {
  return name.find('/') == std::string::npos && !IsModelFile(name);
}

// Returns where a user's object lies below a root of ROBOCELL_MODEL_PATH.
std::string ObjectFile(const std::string& name) { return "objects/" + name + "/" + name + ".xml"; }

// Returns true for the file of a user's object, which only this machine has.
bool IsUsersObject(const std::string& name, const fs::path& path) {
  const std::vector<std::string> roots = ModelPathRoots();
  return IsPlainName(name) && std::ranges::any_of(roots, [&](const std::string& root) {
           std::error_code error;
           return fs::equivalent(fs::path(root) / ObjectFile(name), path, error);
         });
}

bool TryBuiltin(Search& search, const std::string& name) {
  const fs::path root = ModelsRoot();
  const std::string file = name + "/" + name + ".xml";
  return search.TryBelow(root / "robots", file) || search.TryBelow(root / "objects", file) ||
         search.TryBelow(root / "equipment", file) ||
         search.TryBelow(root / "scenes", name + ".xml");
}

// Returns " Did you mean 'menagerie:franka_emika_panda'?" for the name, without the prefix, of a
// robot of the Menagerie that is on this machine, or of one of its files.
std::string MenagerieHint(const std::string& name) {
  const size_t slash = std::min(name.find('/'), name.size());
  std::vector<std::string> robots;
  for (const auto& [robot, folder] : menagerie::RobotFolders()) robots.push_back(robot);
  const std::vector<std::string> near = NearestNames(name.substr(0, slash), robots, 1);
  if (near.empty()) return "";
  return " Did you mean '" + std::string(kMenagerie) + near[0] + name.substr(slash) + "'?";
}

// Returns true if a robot of the Menagerie has the name as one of its words: "panda" of
// "franka_emika_panda".
bool IsWordOfARobot(const std::string& name) {
  const std::map<std::string, std::string> robots = menagerie::RobotFolders();
  return std::ranges::any_of(robots, [&](const auto& robot) {
    return ("_" + robot.first + "_").find("_" + name + "_") != std::string::npos;
  });
}

std::string BuiltinHint(const std::string& name) {
  const std::vector<std::string> names = BuiltinModels();
  const std::string near = IsWordOfARobot(name) ? "" : DidYouMean(name, names);
  return "Built-in models: " + ListNames(names) + "." + (near.empty() ? MenagerieHint(name) : near);
}

// Returns "Did you mean 'models/stork.xml'?" for `name`, whose file is missing at `path`, if its
// folder has a model with a similar name.
std::string NeighbourHint(const std::string& name, const fs::path& path) {
  std::vector<std::string> models = FolderNamesIfAny(path.parent_path());
  std::erase_if(models, [](const fs::path& name) { return !IsModelFile(name); });
  const std::vector<std::string> near = NearestNames(path.filename().string(), models, 1);
  if (near.empty()) return "";
  return "Did you mean '" + (fs::path(name).parent_path() / near[0]).string() + "'?";
}

// A requested file of the Menagerie without its prefix is a likely mistake.
std::string PathHint(const std::string& name) {
  return "More roots can be given in ROBOCELL_MODEL_PATH; robots of the Menagerie are named like "
         "menagerie:ufactory_xarm7/xarm7.xml" +
         std::string(name.find('~') == 0 ? "; `~` is not expanded here." : ".") +
         MenagerieHint(name);
}

}  // namespace

std::vector<std::string> ModelPathRoots() {
  std::vector<std::string> roots;
  std::string rest = internal::Environment("ROBOCELL_MODEL_PATH");
  while (!rest.empty()) {
    const size_t colon = rest.find(':');
    if (const std::string root = rest.substr(0, colon); !root.empty()) roots.push_back(root);
    rest = colon == std::string::npos ? "" : rest.substr(colon + 1);
  }
  return roots;
}

std::string Resolve(const std::string& name, const std::string& directory) {
  if (name.empty()) throw ArgumentError("the name of a model is empty");
  internal::RequireNoNul("model", name);
  if (name.rfind(kMenagerie, 0) == 0) return menagerie::ModelPath(name.substr(kMenagerie.size()));
  Search search;
  const fs::path path = name;
  if (path.is_absolute()) {
    if (search.TryFile(path)) return search.found();
    internal::ThrowNotFound("model file '" + name + "'", search.looked(),
                            NeighbourHint(name, path));
  }
  if (IsPlainName(name)) {
    if (auto file = OverrideFile(name)) return *file;
  }
  if (!directory.empty() && search.TryFile(fs::path(directory) / path)) return search.found();
  if (search.TryFile(path)) return search.found();
  for (const std::string& root : ModelPathRoots()) {
    if (search.TryBelow(root, name)) return search.found();
    const bool may_be_object = IsPlainName(name) && !IsBuiltinOtherThanObject(name);
    if (may_be_object && search.TryBelow(root, ObjectFile(name))) return search.found();
  }
  if (!IsPlainName(name)) {
    const std::string near = NeighbourHint(name, search.looked().front());
    internal::ThrowNotFound("model file '" + name + "'", search.looked(),
                            near.empty() ? PathHint(name) : near);
  }
  if (TryBuiltin(search, name)) return search.found();
  internal::ThrowNotFound("model '" + name + "'", search.looked(), BuiltinHint(name));
}

namespace {

namespace fs = std::filesystem;

constexpr size_t kVersionLength = 17;  // "-" and 16 digits: the Menagerie's folders in its cache

bool Means(const std::string& name, const fs::path& path) {
  if (!internal::Environment(OverrideVariable(name).c_str()).empty()) return false;  // here only
  if (IsUsersObject(name, path)) return false;
  try {
    std::error_code error;
    return fs::equivalent(Resolve(name), path, error);
  } catch (const Error&) {
    return false;
  }
}

// Returns the names that the file would have as a built-in model or in the Menagerie.
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

std::string OverrideVariable(const std::string& name) {
  std::string variable = "ROBOCELL_OVERRIDE_";
  const size_t start = name.starts_with(kMenagerie) ? kMenagerie.size() : 0;
  for (const char c : name.substr(start)) {
    const bool lower = c >= 'a' && c <= 'z';
    const bool other = (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    variable += lower ? static_cast<char>(c - 'a' + 'A') : other ? c : '_';
  }
  return variable;
}

std::optional<std::string> OverrideFile(const std::string& name) {
  const std::string variable = OverrideVariable(name);
  const std::string value = internal::Environment(variable.c_str());
  if (value.empty()) return std::nullopt;
  std::error_code error;
  if (fs::is_regular_file(value, error)) return fs::absolute(value, error).lexically_normal();
  throw NotFoundError(
      fmt::format("{} is '{}', which is not a file; it replaces the model '{}': correct the "
                  "variable or unset it",
                  variable, value, name));
}

}  // namespace robocell::assets
