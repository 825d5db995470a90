#include "robocell/scenes/houses/house_map.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/media/png.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

constexpr double kPixel = 0.02;  // metres, to which edges are exact

// Two rooms of 3 by 2 m side by side along x, with a taken square in the first.
HouseMap TwoRooms() {
  HouseMap map = MakeHouseMap({-1, -1}, {7, 3}, 50);
  for (int row = 0; row < map.rows; ++row) {
    for (int column = 0; column < map.columns; ++column) {
      const Eigen::Vector2d at = map.PositionOf(row, column);
      const auto pixel = static_cast<size_t>(row * map.columns + column);
      if (at.y() < 0 || at.y() > 2 || at.x() < 0 || at.x() > 6) continue;
      map.room[pixel] = at.x() < 3 ? 1 : 2;
      map.free[pixel] = !(at.x() < 1 && at.y() < 1);
    }
  }
  map.room_names = {{1, "room|1"}, {2, "hall"}};
  return map;
}

std::filesystem::path Write(const TempDir& folder, const std::vector<uint8_t>& bytes) {
  AtomicWrite(folder / "map.png", std::string(bytes.begin(), bytes.end()));
  return folder / "map.png";
}

TEST(HouseMap, PixelsAndPositionsAreInverse) {
  const HouseMap map = TwoRooms();
  for (const int row : {0, 17, map.rows - 1}) {
    for (const int column : {0, 31, map.columns - 1}) {
      const Eigen::Vector2d at = map.PositionOf(row, column);
      EXPECT_EQ(map.PixelAt(at.x(), at.y()), row * map.columns + column);
    }
  }
  EXPECT_EQ(map.PixelAt(100, 0), -1);
  EXPECT_EQ(map.RoomNameAt(1, 1.5), "room|1");
  EXPECT_EQ(map.RoomNameAt(5, 1), "hall");
  EXPECT_EQ(map.RoomNameAt(-0.5, 1), "");
  EXPECT_TRUE(map.IsFree(1.5, 0.5));
  EXPECT_FALSE(map.IsFree(0.5, 0.5));
}

TEST(HouseMap, RoundTripsThroughItsPicture) {
  const TempDir folder;
  const HouseMap map = TwoRooms();
  const HouseMap back = ReadHouseMap(Write(folder, EncodeHouseMap(map)));
  EXPECT_EQ(back.free, map.free);
  EXPECT_EQ(back.room, map.room);
  EXPECT_EQ(back.world_to_map, map.world_to_map);
  EXPECT_EQ(back.pixels_per_metre, map.pixels_per_metre);
  EXPECT_EQ(back.room_names, map.room_names);
}

TEST(HouseMap, FreeFloorIsFreeAndNearlyAllOfIt) {
  const HouseMap map = TwoRooms();
  double total = 0;
  for (const FloorArea& area : FreeFloorOf(map, 0.1)) {
    const Eigen::Vector3d middle = area.frame_to_world.translation();
    EXPECT_EQ(middle.z(), 0.1);
    EXPECT_EQ(area.room, middle.x() < 3 ? "room|1" : "hall");
    for (double u = -1; u <= 1; u += 0.1) {
      for (double v = -1; v <= 1; v += 0.1) {
        const double x = middle.x() + u * (area.half_x - kPixel),
                     y = middle.y() + v * (area.half_y - kPixel);
        EXPECT_TRUE(map.IsFree(x, y)) << x << " " << y;
      }
    }
    total += 4 * area.half_x * area.half_y;
  }
  EXPECT_GT(total, 0.85 * 11);  // 12 square metres and a taken one
  const std::vector<Room> rooms = RoomsOf(map, 0);
  ASSERT_EQ(rooms.size(), 2U);
  EXPECT_EQ(rooms[0].name, "room|1");
  EXPECT_EQ(rooms[0].outline.size(), 4U);
}

// The picture has a few kilobytes, and the cells of 5 cm would fill 25 GB.
TEST(HouseMap, FreeFloorOfSquareKilometresHasLargerCells) {
  HouseMap map = MakeHouseMap({0, 0}, {4096, 4096}, 1);
  map.free.assign(map.free.size(), true);
  const std::vector<FloorArea> areas = FreeFloorOf(map, 0);
  ASSERT_EQ(areas.size(), 1U);
  EXPECT_NEAR(areas[0].half_x, 2048, 8);
  EXPECT_NEAR(areas[0].half_y, 2048, 8);
}

TEST(HouseMap, DamagedPicturesSayWhatIsWrong) {
  const TempDir folder;
  const auto with = [&](PngTexts texts) {
    return Write(folder, EncodePng(4, 4, std::vector<uint8_t>(48, 255), texts));
  };
  const std::string matrix = "[[-50, 0, 0, 2], [0, -50, 0, 2]]";
  ExpectThrow<IoError>([&] { ReadHouseMap(with({})); }, "no text 'world_to_map'");
  ExpectThrow<IoError>([&] { ReadHouseMap(with({{"world_to_map", "[[1, 2"}})); }, "not JSON");
  ExpectThrow<IoError>(
      [&] {
        ReadHouseMap(with({{"world_to_map", "[[1, 2], [3]]"}}));
      },
      "not two rows of four numbers");
  ExpectThrow<IoError>(
      [&] {
        ReadHouseMap(with({{"world_to_map", matrix}, {"px_per_m", "20"}}));
      },
      "contradict each other");
  ExpectThrow<IoError>(
      [&] {
        ReadHouseMap(with({{"world_to_map", "[[0, 0, 0, 0], [0, 0, 0, 0]]"}, {"px_per_m", "50"}}));
      },
      "contradict each other");
  ExpectThrow<IoError>(
      [&] {
        ReadHouseMap(
            with({{"world_to_map", "[[-50, 0, 0, 1e9], [0, -50, 0, 2]]"}, {"px_per_m", "50"}}));
      },
      "kilometres");
  for (const char* number : {"NaN", "1e999", "null", "\"50\"", "0", "-50", "1e300"})
    EXPECT_THROW(ReadHouseMap(with({{"world_to_map", matrix}, {"px_per_m", number}})), IoError)
        << number;
  for (const char* number : {"NaN", "1e999", "null", "\"2\""}) {
    const std::string bad = std::string("[[-50, 0, 0, ") + number + "], [0, -50, 0, 2]]";
    EXPECT_THROW(ReadHouseMap(with({{"world_to_map", bad}, {"px_per_m", "50"}})), IoError)
        << number;
  }
  EXPECT_TRUE(ReadHouseMap(with({{"world_to_map", matrix}, {"px_per_m", "50"}})).room.empty());
}

}  // namespace
}  // namespace robocell::internal
