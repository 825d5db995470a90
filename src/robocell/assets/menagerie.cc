// The MuJoCo Menagerie on this machine: a checkout (MENAGERIE_ROOT) or the cache of the Python
// package mujoco-menagerie, which publishes a model as models/<name>-<16 hex digits>/ with a file
// `.complete` in it.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <mutex>
#include <set>

#include <nlohmann/json.hpp>

#include "robocell/assets/resolve.h"
#include "robocell/assets/roots.h"
#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/log.h"
#include "robocell/base/real_file.h"
#include "robocell/base/suggestions.h"

namespace robocell::menagerie {
namespace {

namespace fs = std::filesystem;

constexpr size_t kVersionDigits = 16;

fs::path CacheModels() {
  if (const std::string dir = internal::Environment("MENAGERIE_CACHE_DIR"); !dir.empty())
    return fs::path(dir) / "models";
  return internal::UserCacheFolder() / "mujoco_menagerie" / "models";
}

bool IsVersionOf(const std::string& folder, const std::string& robot) {
  return folder.size() == robot.size() + 1 + kVersionDigits && folder.rfind(robot + "-", 0) == 0;
}

// Returns the folder of the version that `robocell fetch` has recorded, which stays until another
// is requested; empty without one. It need not exist. `robocell fetch` reports problems of the
// record.
fs::path RecordedFolder(const std::string& robot) {
  const fs::path record = internal::UserCacheFolder() / "robocell/menagerie.json";
  if (!internal::CanReadFile(record)) return {};
  const auto json = nlohmann::json::parse(internal::ReadRealFile(record), nullptr, false);
  if (json.is_discarded() || robot.find_first_of("~/") != std::string::npos) return {};
  const auto tree = nlohmann::json::json_pointer("/robots/" + robot + "/tree");
  if (!json.contains(tree) || !json[tree].is_string()) return {};
  return CacheModels() / (robot + "-" + json[tree].get<std::string>().substr(0, kVersionDigits));
}

// Warns once per process for each robot: names are looked up many times.
void WarnOfOtherVersion(const std::string& robot, const fs::path& recorded, const fs::path& other) {
  static std::mutex mutex;
  static std::set<std::string> warned;
  {
    const std::lock_guard lock(mutex);
    if (!warned.insert(recorded.string()).second) return;
  }
  LogWarn(
      fmt::format("menagerie robot '{0}': the version that `robocell fetch` recorded is not in the "
                  "cache ('{1}'), and '{2}' is taken in its place. `robocell fetch {0}` gets the "
                  "recorded one or says how; with --update the package's version is recorded",
                  robot, recorded.string(), other.filename().string()));
}

// Returns the version of a robot that was published last; empty if there is none.
fs::path NewestFolder(const std::string& robot) {
  fs::path newest;
  fs::file_time_type newest_time{};
  for (const std::string& folder : FolderNamesIfAny(CacheModels())) {
    std::error_code error;
    const fs::path path = CacheModels() / folder;
    const auto time = fs::last_write_time(path / ".complete", error);
    if (error || !IsVersionOf(folder, robot)) continue;
    if (newest.empty() || time >= newest_time) newest = path, newest_time = time;
  }
  return newest;
}

// Returns the recorded version of a robot, else the one that was published last; empty if there is
// none.
fs::path CachedFolder(const std::string& robot) {
  std::error_code error;
  const fs::path recorded = RecordedFolder(robot);
  if (!recorded.empty() && fs::exists(recorded / ".complete", error)) return recorded;
  return NewestFolder(robot);
}

// Returns the robot models in a folder: neither scenes nor the variants for MJX.
std::vector<std::string> ModelStems(const fs::path& folder) {
  std::vector<std::string> stems;
  for (const std::string& file : FolderNamesIfAny(folder)) {
    const std::string stem = fs::path(file).stem().string();
    if (fs::path(file).extension() != ".xml") continue;
    if (stem.rfind("scene", 0) == 0 || stem.rfind("mjx_", 0) == 0) continue;
    stems.push_back(stem);
  }
  return stems;
}

std::string WithoutUnderscores(std::string text) {
  std::erase(text, '_');
  return text;
}

bool EndsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

// Returns the model named like its folder without the maker (kinova_gen3/gen3.xml), else the only
// one.
std::string MainFile(const std::string& robot, const fs::path& folder) {
  const std::vector<std::string> stems = ModelStems(folder);
  std::string best;
  for (const std::string& stem : stems) {
    if (EndsWith(WithoutUnderscores(robot), WithoutUnderscores(stem)) && stem.size() > best.size())
      best = stem;
  }
  if (best.empty() && stems.size() == 1) best = stems[0];
  if (!best.empty()) return best + ".xml";
  if (stems.empty())
    throw NotFoundError(
        fmt::format("menagerie robot '{}': no model file in {}", robot, folder.string()));
  throw ArgumentError(
      fmt::format("menagerie robot '{0}' has several models; name one, for example "
                  "menagerie:{0}/{1}.xml. Its models: {2}",
                  robot, stems[0], ListNames(stems)));
}

// Returns the name of a cached version without its digits; empty if it is not a version.
std::string RobotOfVersion(const std::string& folder) {
  const std::string robot = folder.substr(0, folder.rfind('-'));
  return IsVersionOf(folder, robot) ? robot : "";
}

// Returns the robot on this machine that was probably meant, or how to get another.
std::string Remedy(const std::string& robot) {
  std::vector<std::string> robots;
  for (const auto& [name, folder] : RobotFolders()) robots.push_back(name);
  const std::string near = DidYouMean(robot, robots);
  const std::string fetch = "robocell fetch " + robot;
  if (!near.empty()) return near.substr(1) + " Else fetch it with: " + fetch;
  const std::string here = robots.empty() ? "" : "On this machine: " + ListNames(robots) + ". ";
  return here + "Fetch it with: " + fetch;
}

}  // namespace

std::string RobotFolder(const std::string& robot) {
  std::vector<std::string> looked;
  if (const std::string root = internal::Environment("MENAGERIE_ROOT"); !root.empty()) {
    std::error_code error;
    if (fs::is_directory(fs::path(root) / robot, error)) return (fs::path(root) / robot).string();
    looked.push_back((fs::path(root) / robot).string() + " (MENAGERIE_ROOT)");
  } else {
    looked.push_back("MENAGERIE_ROOT (not set)");
  }
  if (const fs::path cached = CachedFolder(robot); !cached.empty()) {
    const fs::path recorded = RecordedFolder(robot);
    if (!recorded.empty() && cached != recorded) WarnOfOtherVersion(robot, recorded, cached);
    return cached.string();
  }
  looked.push_back((CacheModels() / (robot + "-*")).string());
  internal::ThrowNotFound("menagerie robot '" + robot + "'", looked, Remedy(robot));
}

std::map<std::string, std::string> RobotFolders() {
  std::map<std::string, std::string> robots;
  for (const std::string& folder : FolderNamesIfAny(CacheModels())) {
    const std::string robot = RobotOfVersion(folder);
    const fs::path newest = robot.empty() ? fs::path() : CachedFolder(robot);
    if (!newest.empty()) robots[robot] = newest.string();
  }
  const std::string root = internal::Environment("MENAGERIE_ROOT");
  if (root.empty()) return robots;
  for (const std::string& robot : FolderNamesIfAny(root)) {
    const fs::path folder = fs::path(root) / robot;
    if (!ModelStems(folder).empty()) robots[robot] = folder.string();
  }
  return robots;
}

std::string ModelPath(const std::string& name) {
  const size_t slash = name.find('/');
  const std::string robot = name.substr(0, slash);
  if (robot.empty() || robot == "." || robot == "..") {
    throw ArgumentError("'menagerie:" + name +
                        "' names no robot; write for example menagerie:ufactory_xarm7/xarm7.xml");
  }
  if (auto file = assets::OverrideFile(name)) return *file;
  const fs::path folder = RobotFolder(robot);
  const std::string file =
      slash == std::string::npos ? MainFile(robot, folder) : name.substr(slash + 1);
  if (const auto found = internal::FindBelow(folder, file)) return found->string();
  std::vector<std::string> files = ModelStems(folder);
  for (std::string& stem : files) stem += ".xml";
  throw NotFoundError(
      NoSuchName("menagerie robot '" + robot + "' (" + folder.string() + ")", "file", file, files));
}

}  // namespace robocell::menagerie
