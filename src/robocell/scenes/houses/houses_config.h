// HousesScenes: the fields of the scene source `houses`.
//
//   scenes: {source: houses}                                    # the built-in houses
//   scenes: {source: houses, dataset: procthor-10k, houses: [3, 7..20]}
//   scenes: {source: houses, root: my_houses}
#pragma once

#include <optional>
#include <string>

#include "robocell/spec/containers.h"
#include "robocell/spec/fields.h"
#include "robocell/spec/problems.h"

namespace robocell {

struct HousesScenes {
  std::optional<std::string> dataset = {};
  std::optional<std::string> root = {};
  std::optional<std::string> split = {};
  bool ceiling = true;
  NameList without = {};
  std::optional<std::string> blacklist = {};

  static constexpr const char* kKind = "houses";
  static constexpr const char* kTypeName = "HousesScenes";
  template <class V>
  static void Fields(V&& v) {
    v("dataset", &HousesScenes::dataset,
      "The name of a set of houses, such as procthor-10k, in one of the folders of "
      "ROBOCELL_SCENE_PATH. Unset, without `root`: the 20 built-in houses.");
    v("root", &HousesScenes::root,
      "The folder of the houses, or a folder of sets with `dataset`. Relative paths start at the "
      "run file.");
    v("split", &HousesScenes::split,
      "The split of the set: train, val or test. Unset: train, or the only one.");
    v("ceiling", &HousesScenes::ceiling, "Use the variant with a ceiling, where there is one.");
    v("without", &HousesScenes::without,
      "Objects that are left out: ids of their assets, or names of their bodies.");
    v("blacklist", &HousesScenes::blacklist,
      "A file with one entry a line: the number of a house that is left out, or an entry of "
      "`without`. Unset: blacklist.txt in the folder of the houses, if there is one.");
  }
  void Validate(Problems& problems) const;
};

// The number of built-in houses.
inline constexpr int kBuiltInHouses = 20;

}  // namespace robocell
