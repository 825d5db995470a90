#include "robocell/scenes/houses/house_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>
#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "robocell/base/error.h"
#include "robocell/media/png.h"
#include "robocell/scenes/free_floor.h"
#include "robocell/scenes/free_rectangles.h"

namespace robocell::internal {
namespace {

constexpr double kMapCell = 0.05;                       // metres
constexpr double kMostMapCells = 1e6;                   // larger maps get larger cells
constexpr int kSamples = 4;                             // per cell, along each side
constexpr double kLeastScale = 1, kMostScale = 10'000;  // per metre
constexpr double kMostCoordinate = 10'000;              // metres
constexpr int kMostRooms = 255;
constexpr const char *kWorldToMap = "world_to_map", *kMapToWorld = "map_to_world",
                     *kPixelsPerMetre = "px_per_m", *kRoomNames = "room_ids_to_name";

[[noreturn]] void Fail(const std::filesystem::path& path, const std::string& reason) {
  throw IoError(fmt::format("map '{}': {}", path.string(), reason));
}

// A text of the picture as JSON.
nlohmann::json JsonOf(const PngTexts& texts, const char* key, const std::filesystem::path& path) {
  const auto text = texts.find(key);
  if (text == texts.end())
    Fail(path,
         fmt::format("the picture has no text '{}', which relates its pixels to the world", key));
  nlohmann::json json = nlohmann::json::parse(text->second, nullptr, false);
  if (json.is_discarded()) Fail(path, fmt::format("its text '{}' is not JSON", key));
  return json;
}

// Reads the rows of world_to_map.
std::array<std::array<double, 4>, 2> MatrixOf(const nlohmann::json& json,
                                              const std::filesystem::path& path) {
  std::array<std::array<double, 4>, 2> out = {};
  const auto fail = [&] { Fail(path, "its text 'world_to_map' is not two rows of four numbers"); };
  if (!json.is_array() || json.size() != 2) fail();
  for (size_t row = 0; row < 2; ++row) {
    if (!json[row].is_array() || json[row].size() != 4) fail();
    for (size_t i = 0; i < 4; ++i) {
      if (!json[row][i].is_number()) fail();
      out[row][i] = json[row][i].get<double>();
      if (!std::isfinite(out[row][i])) fail();
    }
  }
  return out;
}

double Determinant(const HouseMap& map) {
  return map.world_to_map[0][0] * map.world_to_map[1][1] -
         map.world_to_map[0][1] * map.world_to_map[1][0];
}

std::string NameOf(const HouseMap& map, int room) {
  if (room == 0) return "";
  const auto name = map.room_names.find(room);
  return name == map.room_names.end() ? fmt::format("room_{}", room) : name->second;
}

}  // namespace

int64_t HouseMap::PixelAt(double x, double y) const {
  const auto along = [&](const std::array<double, 4>& row) {
    return std::round(row[0] * x + row[1] * y + row[3]);
  };
  const double row = along(world_to_map[0]), column = along(world_to_map[1]);
  if (!(row >= 0 && row < rows && column >= 0 && column < columns)) return -1;
  return static_cast<int64_t>(row) * columns + static_cast<int64_t>(column);
}

bool HouseMap::IsFree(double x, double y) const {
  const int64_t pixel = PixelAt(x, y);
  return pixel >= 0 && free[static_cast<size_t>(pixel)];
}

int HouseMap::RoomAt(double x, double y) const {
  const int64_t pixel = PixelAt(x, y);
  return pixel < 0 || room.empty() ? 0 : room[static_cast<size_t>(pixel)];
}

std::string HouseMap::RoomNameAt(double x, double y) const { return NameOf(*this, RoomAt(x, y)); }

Eigen::Vector2d HouseMap::PositionOf(int row, int column) const {
  const auto& [of_row, of_column] = world_to_map;
  const double determinant = Determinant(*this);
  const double r = row - of_row[3], c = column - of_column[3];
  return {(of_column[1] * r - of_row[1] * c) / determinant,
          (of_row[0] * c - of_column[0] * r) / determinant};
}

HouseMap MakeHouseMap(const Eigen::Vector2d& low, const Eigen::Vector2d& high,
                      double pixels_per_metre) {
  HouseMap map;
  map.rows = static_cast<int>(std::lround((high - low).x() * pixels_per_metre));
  map.columns = static_cast<int>(std::lround((high - low).y() * pixels_per_metre));
  const Eigen::Vector2d middle = (low + high) / 2;
  const double k = pixels_per_metre;
  map.world_to_map = {{{-k, 0, 0, k * middle.x() + map.rows / 2.0},
                       {0, -k, 0, k * middle.y() + map.columns / 2.0}}};
  map.pixels_per_metre = k;
  map.free.assign(static_cast<size_t>(map.rows) * static_cast<size_t>(map.columns), false);
  map.room.assign(map.free.size(), 0);
  return map;
}

HouseMap ReadHouseMap(const std::filesystem::path& path) {
  const PngTexts texts = ReadPngTexts(path, kMostMapPixels);
  const RgbImage image = ReadPngRgb(path, kMostMapPixels);
  HouseMap map;
  map.rows = image.height;
  map.columns = image.width;
  map.world_to_map = MatrixOf(JsonOf(texts, kWorldToMap, path), path);
  const nlohmann::json scale = JsonOf(texts, kPixelsPerMetre, path);
  if (!scale.is_number()) Fail(path, "its text 'px_per_m' is not a number");
  map.pixels_per_metre = scale.get<double>();
  if (!(map.pixels_per_metre >= kLeastScale && map.pixels_per_metre <= kMostScale))
    Fail(path, fmt::format("it has {:g} pixels per metre; {:g} to {:g} are read",
                           map.pixels_per_metre, kLeastScale, kMostScale));
  const double area = std::sqrt(std::abs(Determinant(map)));
  if (!(std::abs(area - map.pixels_per_metre) <= 0.05 * map.pixels_per_metre))
    Fail(path,
         fmt::format("its texts contradict each other: 'px_per_m' says {:g} pixels per metre, "
                     "and 'world_to_map' {:g}",
                     map.pixels_per_metre, area));
  for (const int row : {0, map.rows - 1}) {
    for (const int column : {0, map.columns - 1}) {
      if (!(map.PositionOf(row, column).norm() <= kMostCoordinate))
        Fail(path, "its text 'world_to_map' puts it kilometres away");
    }
  }
  const size_t pixels = static_cast<size_t>(map.rows) * static_cast<size_t>(map.columns);
  map.free.resize(pixels);
  map.room.resize(pixels);
  bool is_gray = true;
  for (size_t i = 0; i < pixels; ++i) {
    map.free[i] = image.pixels[3 * i] > 0;
    map.room[i] = image.pixels[3 * i + 2];
    is_gray &= image.pixels[3 * i] == image.pixels[3 * i + 2];
  }
  if (is_gray) map.room.clear();
  if (const auto names = texts.find(kRoomNames); names != texts.end()) {
    const nlohmann::json json = JsonOf(texts, kRoomNames, path);
    if (!json.is_object() && !json.is_null())
      Fail(path, "its text 'room_ids_to_name' is not a list of names by number");
    for (const auto& [key, value] : json.items()) {
      const int number = std::atoi(key.c_str());
      if (number < 1 || !value.is_string())
        continue;  // the original has rooms beyond 255 pixels' values
      if (number <= kMostRooms) map.room_names[number] = value.get<std::string>();
    }
  }
  return map;
}

std::vector<uint8_t> EncodeHouseMap(const HouseMap& map) {
  std::vector<uint8_t> pixels;
  pixels.reserve(3 * map.free.size());
  for (size_t i = 0; i < map.free.size(); ++i) {
    const uint8_t free = map.free[i] ? 255 : 0;
    pixels.insert(pixels.end(), {free, free, map.room.empty() ? free : map.room[i]});
  }
  const Eigen::Vector2d corner = map.PositionOf(0, 0);
  const Eigen::Vector2d down = map.PositionOf(1, 0) - corner, right = map.PositionOf(0, 1) - corner;
  nlohmann::json names = nlohmann::json::object();
  for (const auto& [number, name] : map.room_names) names[std::to_string(number)] = name;
  const nlohmann::json map_to_world = {
      {down.x(), right.x(), corner.x()}, {down.y(), right.y(), corner.y()}, {0.0, 0.0, 0.0}};
  return EncodePng(map.columns, map.rows, pixels,
                   {{kWorldToMap, nlohmann::json(map.world_to_map).dump()},
                    {kMapToWorld, map_to_world.dump()},
                    {kPixelsPerMetre, nlohmann::json(map.pixels_per_metre).dump()},
                    {kRoomNames, names.dump()}});
}

std::vector<FloorArea> FreeFloorOf(const HouseMap& map, double floor_height) {
  Eigen::AlignedBox2d world;
  for (const int row : {0, map.rows - 1}) {
    for (const int column : {0, map.columns - 1}) world.extend(map.PositionOf(row, column));
  }
  // A picture of kilobytes may show square kilometres.
  const double side = std::max(kMapCell, std::sqrt(world.volume() / kMostMapCells));
  const int nx = static_cast<int>(world.sizes().x() / side),
            ny = static_cast<int>(world.sizes().y() / side);
  if (nx < 1 || ny < 1) return {};
  const Eigen::Vector2d low = world.center() - Eigen::Vector2d(nx, ny) * side / 2;
  const int least = static_cast<int>(std::ceil(kLeastSide / side - 1e-9));
  // A cell belongs to a room if all of it is free floor of that room.
  std::vector<int> rooms(static_cast<size_t>(nx) * static_cast<size_t>(ny), -1);
  std::vector<int> known;
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i) {
      int room = -1;
      bool is_free = true;
      for (int s = 0; s < kSamples * kSamples && is_free; ++s) {
        const int column = s % kSamples, row = s / kSamples;
        const double x = low.x() + (i + (column + 0.5) / kSamples) * side;
        const double y = low.y() + (j + (row + 0.5) / kSamples) * side;
        const int here = map.RoomAt(x, y);
        if (s == 0) room = here;
        is_free = map.IsFree(x, y) && here == room;
      }
      if (!is_free) continue;
      rooms[static_cast<size_t>(j) * static_cast<size_t>(nx) + static_cast<size_t>(i)] = room;
      if (std::ranges::find(known, room) == known.end()) known.push_back(room);
    }
  }
  std::vector<FloorArea> areas;
  for (const int room : known) {
    std::vector<bool> taken(rooms.size());
    for (size_t cell = 0; cell < rooms.size(); ++cell) taken[cell] = rooms[cell] != room;
    for (int n = 0; n < kMostAreasOfMap; ++n) {
      const std::optional<CellRectangle> best = TakeLargest(taken, nx, ny, least);
      if (!best) break;
      const Eigen::Vector2d at =
          low + Eigen::Vector2d(best->i + best->width / 2.0, best->j + best->height / 2.0) * side;
      areas.push_back({.frame_to_world = Pose(Eigen::Vector3d(at.x(), at.y(), floor_height)),
                       .half_x = best->width * side / 2,
                       .half_y = best->height * side / 2,
                       .room = NameOf(map, room)});
    }
  }
  std::ranges::stable_sort(areas, std::greater<>(),
                           [](const FloorArea& area) { return area.half_x * area.half_y; });
  if (areas.size() > static_cast<size_t>(kMostAreasOfMap)) areas.resize(kMostAreasOfMap);
  return areas;
}

std::vector<Room> RoomsOf(const HouseMap& map, double floor_height) {
  std::map<int, std::vector<Eigen::Vector2d>> edges;  // first and last pixels of each row
  for (int row = 0; row < map.rows && !map.room.empty(); ++row) {
    const auto room_at = [&](int column) {
      if (column < 0 || column >= map.columns) return 0;
      return int{map.room[static_cast<size_t>(row) * static_cast<size_t>(map.columns) +
                          static_cast<size_t>(column)]};
    };
    for (int column = 0; column < map.columns; ++column) {
      const int room = room_at(column);
      if (room != 0 && (room_at(column - 1) != room || room_at(column + 1) != room))
        edges[room].push_back(map.PositionOf(row, column));
    }
  }
  std::vector<Room> rooms;
  for (auto& [number, points] : edges) {
    Room room{.name = NameOf(map, number), .floor_height = floor_height};
    for (const Eigen::Vector2d& corner : ConvexHull(std::move(points)))
      room.outline.push_back({corner.x(), corner.y()});
    if (room.outline.size() >= 3) rooms.push_back(std::move(room));
  }
  return rooms;
}

}  // namespace robocell::internal
