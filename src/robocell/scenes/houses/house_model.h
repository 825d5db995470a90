// The MuJoCo model of a furnished house: as XML that stock MuJoCo loads, with its objects at rest.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "robocell/scenes/houses/furnished_house.h"

namespace robocell::internal {

struct SettledHouse {
  FurnishedHouse house;  // with the objects that came to rest in their slots, where they rest
  std::string xml, ceiling_xml;
  int removed = 0;  // objects that did not come to rest
};

// Lets the objects come to rest and writes both variants. `folder`: where the files will be, with
// the textures in kTextureFolder. `name`: of the model.
SettledHouse SettleHouse(FurnishedHouse house, const std::string& name,
                         const std::filesystem::path& folder);
// Returns the name of the site that marks slot `number` of its body.
std::string SlotSiteName(const FilledSlot& slot, int number);
inline constexpr const char* kTextureFolder = "assets";

}  // namespace robocell::internal
