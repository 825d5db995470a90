// Prepares a house for a scene: checks its files, mends what is known to be wrong in such houses in a
// copy of the model, and checks that it compiles.
//
//   const PreparedHouse house = PrepareHouse(files, folder);
//   if (house.why_not.empty()) spec.base = house.model.string();
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "robocell/scenes/houses/house_folder.h"

namespace robocell::internal {

struct PreparedHouse {
  std::string why_not = {};  // "" for a house that can be used
  std::filesystem::path model = {};
  std::vector<std::string> notes = {};  // what was mended or left out
};

// Returns what was prepared before on this machine, unless the files changed.
PreparedHouse PrepareHouse(const HouseFiles& files, const HouseFolder& folder);

// Returns ROBOCELL_CACHE_DIR/houses, or its default place.
std::filesystem::path HousesCacheFolder();

}  // namespace robocell::internal
