// The files of a set of houses: `<split>_<i>.xml` with `_ceiling.xml`, `_map.png` and
// `_metadata.json` beside it, in one folder. FloorPlan<i>_physics.xml is a house too.
//
//   const HouseFolder folder = HouseFolder::Find({.dataset = "procthor-10k"}, "");
//   folder.houses().at(3).model   // .../procthor-10k-train/train_3_ceiling.xml
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "robocell/scenes/houses/houses_config.h"

namespace robocell::internal {

// Files that are missing have an empty path.
struct HouseFiles {
  std::filesystem::path file;   // the one that gives the house its number
  std::filesystem::path model;  // with a ceiling where that is requested and there is one
  std::filesystem::path map, metadata;
};

class HouseFolder {
 public:
  // Looks for the set of houses. `directory`: where relative paths start. Throws NotFoundError that
  // lists the places, and IoError for a blacklist that cannot be read.
  static HouseFolder Find(const HousesScenes& fields, const std::string& directory);

  const std::filesystem::path& path() const { return path_; }
  const std::map<int, HouseFiles>& houses() const { return houses_; }
  // Returns the largest number and 1: houses may be missing in between.
  int size() const { return houses_.empty() ? 0 : houses_.rbegin()->first + 1; }
  bool IsBlacklisted(int house) const { return blacklisted_.contains(house); }
  // Returns ids of assets, and names of bodies, that are left out.
  const std::vector<std::string>& without() const { return without_; }
  // Returns what is wrong with the folder, such as two files with the same number.
  const std::vector<std::string>& notes() const { return notes_; }
  // Returns the folders in which files of the houses may be: the houses' own one, and those of
  // ROBOCELL_SCENE_PATH.
  const std::vector<std::filesystem::path>& roots() const { return roots_; }

 private:
  void ReadBlacklist(const std::filesystem::path& file);

  std::filesystem::path path_;
  std::map<int, HouseFiles> houses_;
  std::set<int> blacklisted_;
  std::vector<std::string> without_, notes_;
  std::vector<std::filesystem::path> roots_;
};

// Returns the folders of ROBOCELL_SCENE_PATH, separated by ':'.
std::vector<std::filesystem::path> ScenePathRoots();

}  // namespace robocell::internal
