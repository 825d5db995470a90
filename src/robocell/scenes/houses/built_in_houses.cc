#include "robocell/scenes/houses/built_in_houses.h"

#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/version.h"
#include "robocell/scenes/houses/make_houses.h"
#include "robocell/scenes/houses/prepared_house.h"

namespace robocell::internal {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRevision = "1";  // changes with the generator

// The rooms of built-in house `index`: homes, offices, workshops and stores take turns.
HouseOptions OptionsOf(int index) {
  using enum RoomKind;
  static const std::vector<std::vector<RoomKind>> kRooms = {{kKitchen, kLiving},
                                                            {kLiving, kKitchen, kBedroom},
                                                            {kOffice, kKitchen},
                                                            {kWorkshop, kOffice},
                                                            {kWarehouse, kWorkshop}};
  return {.seed = 20,
          .most_objects = 16,
          .prefix = "house_",
          .kinds = kRooms[static_cast<size_t>(index) % kRooms.size()]};
}

}  // namespace

HouseFiles BuiltInHouse(int index, bool ceiling) {
  const fs::path folder =
      HousesCacheFolder() / ("built-in-" + std::string(Version()) + "-" + kRevision);
  const HouseOptions options = OptionsOf(index);
  if (!HasHouse(folder, options, index)) {
    try {
      PrepareHouseFolder(folder, options);
      MakeHouseFiles(folder, options, index);
    } catch (const IoError& error) {
      throw IoError(fmt::format(
          "built-in house {} is made in the cache when it is first used, which failed: {}. Set "
          "ROBOCELL_CACHE_DIR to a folder that can be written",
          index, error.what()));
    }
  }
  const std::string stem = options.prefix + std::to_string(index);
  return {.model = folder / (stem + (ceiling ? "_ceiling.xml" : ".xml")),
          .map = folder / (stem + "_map.png"),
          .metadata = folder / (stem + "_metadata.json")};
}

}  // namespace robocell::internal
