// The generator of houses: a floor plan, furniture, objects at rest, and the files of a house in the
// layout that house_folder.h reads. House i of a seed is always the same, byte by byte.
//
//   PrepareHouseFolder("out", {.seed = 3});
//   for (int i = 0; i < 100; ++i) MakeHouseFiles("out", {.seed = 3}, i);
//   scenes: {source: houses, root: out}
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "robocell/scenes/houses/furnished_house.h"

namespace robocell {

struct HouseOptions {
  uint64_t seed = 0;
  int least_rooms = 3, most_rooms = 6;
  int most_objects = 40;
  std::string prefix = "train_";               // of the files
  std::vector<internal::RoomKind> kinds = {};  // of the rooms, largest first; drawn unless set

  static constexpr int kMostRooms = 40, kMostObjects = 1000;
  // Throws ArgumentError for numbers outside of these.
  void Validate() const;
};

// What a house has.
struct HouseSummary {
  std::string name;  // of its files
  int rooms = 0, pieces = 0, objects = 0, slots = 0, joints = 0;
  int removed = 0;  // objects that did not come to rest, and were left out
};

// Returns a furnished plan, without settling its objects.
internal::FurnishedHouse PlanHouse(const HouseOptions& options, int index);

// Makes the folder with the textures that its houses share. Throws ArgumentError if it has houses
// of other options, and IoError if it cannot be written.
void PrepareHouseFolder(const std::filesystem::path& folder, const HouseOptions& options);
// Makes the files of house `index` in a prepared folder, the model last: a house with a model is
// complete.
HouseSummary MakeHouseFiles(const std::filesystem::path& folder, const HouseOptions& options,
                            int index);
// Returns true if the folder has the complete house.
bool HasHouse(const std::filesystem::path& folder, const HouseOptions& options, int index);

}  // namespace robocell
