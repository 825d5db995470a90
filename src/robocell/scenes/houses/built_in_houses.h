// The built-in houses: small ones of the generator (make_houses.h), written into the cache when
// they are first used.
#pragma once

#include "robocell/scenes/houses/house_folder.h"

namespace robocell::internal {

// Returns the files of built-in house `index`, 0 to kBuiltInHouses - 1. Throws IoError if the cache
// cannot be written.
HouseFiles BuiltInHouse(int index, bool ceiling);

}  // namespace robocell::internal
