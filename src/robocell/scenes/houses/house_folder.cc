#include "robocell/scenes/houses/house_folder.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <optional>
#include <sstream>
#include <string_view>
#include <system_error>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/paths.h"
#include "robocell/base/real_file.h"

namespace robocell::internal {
namespace {

namespace fs = std::filesystem;

constexpr const char* kVariable = "ROBOCELL_SCENE_PATH";
constexpr std::array kSplits = {"train", "val", "test"};
constexpr std::array kKnownSets = {"procthor-10k", "procthor-objaverse", "ithor",
                                   "holodeck-objaverse"};
constexpr std::string_view kModel = ".xml", kCeiling = "_ceiling", kPhysics = "_physics";
constexpr size_t kMostDigits = 7;  // of a house's number
constexpr size_t kMostEntries = 4'000'000;
constexpr size_t kMostSets = 12;  // in a message

struct HouseName {
  std::string series;  // "train_", "FloorPlan"
  int number;
};

// Returns the parts of the name of a house's file, without a ceiling; unset for another file.
std::optional<HouseName> ParseName(std::string name) {
  if (!name.ends_with(kModel)) return std::nullopt;
  name.resize(name.size() - kModel.size());
  if (name.ends_with(kPhysics)) name.resize(name.size() - kPhysics.size());
  size_t digits = name.size();
  while (digits > 0 && std::isdigit(static_cast<unsigned char>(name[digits - 1]))) --digits;
  const size_t count = name.size() - digits;
  if (count == 0 || count > kMostDigits) return std::nullopt;
  return HouseName{name.substr(0, digits), std::atoi(name.c_str() + digits)};
}

// Returns the split that a series names; "" if it names none.
std::string SplitOf(const std::string& series) {
  for (const char* split : kSplits) {
    if (series == std::string(split) + "_") return split;
  }
  return "";
}

bool IsFolder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

fs::path ExistingFile(const fs::path& path) { return CanReadFile(path) ? path : fs::path(); }

// Returns the files of a folder in the order of their names.
std::vector<fs::path> SortedFiles(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  size_t entries = 0;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (++entries > kMostEntries)
      throw IoError(fmt::format("'{}' has more than {} entries; it is no folder of houses",
                                folder.string(), kMostEntries));
    files.push_back(it->path());
  }
  std::ranges::sort(files);
  return files;
}

// The houses of one folder by their series. Of files with the same number the first one by name is
// used, but FloorPlan1_physics.xml rather than FloorPlan1.xml; the others are noted.
std::map<std::string, std::map<int, HouseFiles>> HousesOf(const fs::path& folder, bool ceiling,
                                                          std::vector<std::string>& notes) {
  std::map<std::string, std::map<int, HouseFiles>> series;
  for (const fs::path& file : SortedFiles(folder)) {
    const std::optional<HouseName> name = ParseName(file.filename().string());
    if (!name || !CanReadFile(file)) continue;
    const std::string stem = file.stem().string();
    std::string bare = stem;  // maps and metadata may be named with or without "_physics"
    if (bare.ends_with(kPhysics)) bare.resize(bare.size() - kPhysics.size());
    const auto beside = [&](const std::string& ending) {
      const fs::path own = ExistingFile(folder / (stem + ending));
      return own.empty() ? ExistingFile(folder / (bare + ending)) : own;
    };
    HouseFiles files{.file = file,
                     .model = file,
                     .map = beside("_map.png"),
                     .metadata = beside("_metadata.json")};
    if (ceiling) {
      if (const fs::path variant = beside(std::string(kCeiling) + ".xml"); !variant.empty())
        files.model = variant;
    }
    const auto [place, is_new] = series[name->series].try_emplace(name->number, files);
    if (is_new) continue;
    HouseFiles& known = place->second;
    if (stem.ends_with(kPhysics) && !known.file.stem().string().ends_with(kPhysics))
      std::swap(known, files);
    notes.push_back(fmt::format("'{}' is not used: house {} is '{}'",
                                files.file.filename().string(), name->number,
                                known.file.filename().string()));
  }
  return series;
}

// Chooses the series of a split. Throws NotFoundError for a split that is not there.
std::map<int, HouseFiles> Chosen(std::map<std::string, std::map<int, HouseFiles>> series,
                                 const std::optional<std::string>& split, const fs::path& folder) {
  if (series.size() == 1 && (!split || SplitOf(series.begin()->first).empty()))
    return std::move(series.begin()->second);
  const std::string wanted = split.value_or("train");
  for (auto& [name, houses] : series) {
    if (SplitOf(name) == wanted) return std::move(houses);
  }
  std::vector<std::string> known;
  for (const auto& [name, houses] : series)
    known.push_back(fmt::format("{}<number>.xml ({} houses)", name, houses.size()));
  throw NotFoundError(
      fmt::format("scene source 'houses': '{}' has no houses of split '{}'; it has {}",
                  folder.string(), wanted, fmt::join(known, ", ")));
}

// Returns the places where a set may be, below one root.
std::vector<fs::path> PlacesBelow(const fs::path& root, const std::string& dataset,
                                  const std::string& split) {
  const std::string joined = dataset + "-" + split;
  std::vector<fs::path> places;
  for (const fs::path& base : {root, root / "scenes"}) {
    places.push_back(base / joined);
    places.push_back(base / dataset / split);
    places.push_back(base / dataset);
  }
  return places;
}

std::vector<std::string> SetsBelow(const std::vector<fs::path>& roots) {
  std::vector<std::string> sets;
  for (const fs::path& root : roots) {
    for (const fs::path& base : {root, root / "scenes"}) {
      std::error_code error;
      for (fs::directory_iterator it(base, error), end; !error && it != end; it.increment(error)) {
        if (IsFolder(it->path()) && it->path().filename() != "scenes")
          sets.push_back(it->path().filename().string());
      }
    }
  }
  std::ranges::sort(sets);
  if (sets.size() > kMostSets) sets.resize(kMostSets);
  return sets;
}

std::string Trimmed(const std::string& line) {
  const size_t first = line.find_first_not_of(" \t\r");
  if (first == std::string::npos) return "";
  return line.substr(first, line.find_last_not_of(" \t\r") - first + 1);
}

}  // namespace

std::vector<fs::path> ScenePathRoots() {
  std::vector<fs::path> roots;
  const char* value = std::getenv(kVariable);
  std::istringstream text(value ? value : "");
  for (std::string root; std::getline(text, root, ':');) {
    if (!root.empty()) roots.push_back(fs::absolute(root).lexically_normal());
  }
  return roots;
}

HouseFolder HouseFolder::Find(const HousesScenes& fields, const std::string& directory) {
  const fs::path start = directory.empty() ? fs::current_path() : fs::absolute(directory);
  std::vector<fs::path> roots = ScenePathRoots();
  if (fields.root) {
    RequireNoNul("scene source 'houses': root", *fields.root);
    roots = {(start / *fields.root).lexically_normal()};
  }
  std::vector<fs::path> places;
  if (fields.dataset) {
    if (!ValidFileName(*fields.dataset))
      throw ArgumentError(fmt::format(
          "scene source 'houses': dataset '{}' is the name of a set, such as {}; a folder is given "
          "as `root`",
          *fields.dataset, kKnownSets.front()));
    for (const fs::path& root : roots) {
      for (const fs::path& place :
           PlacesBelow(root, *fields.dataset, fields.split.value_or("train")))
        places.push_back(place);
    }
  } else {
    for (const fs::path& root : roots) {
      if (fields.split) places.push_back(root / *fields.split);
      places.push_back(root);
    }
  }
  HouseFolder folder;
  for (const fs::path& place : places) {
    if (!IsFolder(place)) continue;
    folder.notes_.clear();
    auto series = HousesOf(place, fields.ceiling, folder.notes_);
    if (series.empty()) continue;
    folder.path_ = place;
    folder.houses_ = Chosen(std::move(series), fields.split, place);
    break;
  }
  if (folder.houses_.empty()) {
    std::vector<std::string> looked;
    for (const fs::path& place : places) looked.push_back(place.string());
    const std::string there = fmt::format("{}", fmt::join(SetsBelow(roots), ", "));
    throw NotFoundError(fmt::format(
        "scene source 'houses': no houses{}{}. Looked for train_0.xml and the like in: {}.{} {}",
        fields.dataset ? fmt::format(" of dataset '{}'", *fields.dataset) : "",
        fields.split ? fmt::format(", split '{}'", *fields.split) : "",
        looked.empty() ? fmt::format("nothing ({} is not set)", kVariable)
                       : fmt::format("{}", fmt::join(looked, ", ")),
        there.empty() ? "" : " Folders there: " + there + ".",
        fields.root ? "Give the folder that has the .xml files as `root`; `robocell make-houses` "
                      "writes one"
                    : fmt::format("Set {} to the folder that has '{}' or 'scenes/{}-train', give "
                                  "`root`, or leave `dataset` out for the built-in houses",
                                  kVariable, *fields.dataset, *fields.dataset)));
  }
  folder.roots_ = ScenePathRoots();
  folder.roots_.insert(folder.roots_.begin(), folder.path_);
  if (fields.dataset && fields.root) folder.roots_.push_back(roots.front());
  folder.without_ = fields.without.names;
  if (fields.blacklist)
    folder.ReadBlacklist((start / *fields.blacklist).lexically_normal());
  else if (CanReadFile(folder.path_ / "blacklist.txt"))
    folder.ReadBlacklist(folder.path_ / "blacklist.txt");
  return folder;
}

void HouseFolder::ReadBlacklist(const fs::path& file) {
  std::istringstream text(ReadRealFile(file));
  for (std::string line; std::getline(text, line);) {
    const std::string entry = Trimmed(line.substr(0, line.find('#')));
    if (entry.empty()) continue;
    const std::optional<HouseName> house =
        ParseName(entry.ends_with(kModel) ? entry : entry + std::string(kModel));
    const bool is_house =
        house && entry.size() <= 40 &&
        (house->series.empty() || !SplitOf(house->series).empty() || house->series == "FloorPlan");
    if (is_house)
      blacklisted_.insert(house->number);
    else
      without_.push_back(entry);
  }
}

}  // namespace robocell::internal
