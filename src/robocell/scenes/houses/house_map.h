// HouseMap: where the floor of a house is free, and to which room it belongs, as the picture
// `<house>_map.png` beside the house stores it: red is 255 on free floor, blue is the number of the
// room (0: none), and texts of the PNG relate pixels and world.
//
//   const HouseMap map = ReadHouseMap("train_3_map.png");
//   for (const FloorArea& area : FreeFloorOf(map, 0)) ...
//
// Row 0 is at the largest x of the world, column 0 at its largest y. Gray pictures have no rooms.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "robocell/math/pose.h"
#include "robocell/scenes/scene_annotations.h"

namespace robocell::internal {

inline constexpr uint64_t kMostMapPixels = uint64_t{1} << 26;

struct HouseMap {
  int rows = 0, columns = 0;
  std::vector<bool> free;     // per pixel, row by row
  std::vector<uint8_t> room;  // the same; empty without rooms
  // Pixel of (x, y, z, 1): the rows are the pixel's row and column.
  std::array<std::array<double, 4>, 2> world_to_map = {};
  double pixels_per_metre = 0;
  std::map<int, std::string> room_names = {};

  // Returns the pixel's place in `free`; -1 outside.
  int64_t PixelAt(double x, double y) const;
  bool IsFree(double x, double y) const;
  // Returns the number of the room there; 0 if there is none.
  int RoomAt(double x, double y) const;
  // Returns the name of the room there; "" if there is none.
  std::string RoomNameAt(double x, double y) const;
  // Returns the position of a pixel's middle in the world.
  Eigen::Vector2d PositionOf(int row, int column) const;
};

// Returns an all-taken map of a rectangle of the world.
HouseMap MakeHouseMap(const Eigen::Vector2d& low, const Eigen::Vector2d& high,
                      double pixels_per_metre);

// Throws IoError with the file and what is wrong with it: it is no picture, its texts are missing or
// contradict each other, it is too large.
HouseMap ReadHouseMap(const std::filesystem::path& path);
// Returns the bytes of the PNG, the same for the same map.
std::vector<uint8_t> EncodeHouseMap(const HouseMap& map);

// Returns rectangles of free floor with their rooms, largest first and apart from each other, at
// most kMostAreasOfMap, each at least kLeastSide long and wide.
std::vector<FloorArea> FreeFloorOf(const HouseMap& map, double floor_height);
inline constexpr int kMostAreasOfMap = 40;

// Returns the rooms; their outlines are the convex hulls of their pixels.
std::vector<Room> RoomsOf(const HouseMap& map, double floor_height);

}  // namespace robocell::internal
