// The objects of generated houses, made of simple shapes. Each stands on its origin.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/scenes/houses/floor_plan.h"
#include "robocell/scenes/houses/house_parts.h"

namespace robocell::internal {

// Returns the kinds of objects: "Mug", "Book", ...
std::vector<std::string> HouseObjectKinds();
// Returns those that belong into a room, the most usual first.
std::vector<std::string> HouseObjectsOf(RoomKind room);
// Returns an object with sizes, colours and words drawn from `rng`. Requires one of
// HouseObjectKinds.
HouseThing MakeHouseObject(std::string_view kind, Rng& rng);

}  // namespace robocell::internal
