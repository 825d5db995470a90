#include "robocell/scenes/houses/house_annotations.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <utility>
#include <Eigen/Geometry>

#include "robocell/base/error.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scenes/free_floor.h"
#include "robocell/scenes/free_rectangles.h"
#include "robocell/scenes/houses/house_map.h"
#include "robocell/scenes/houses/house_metadata.h"

namespace robocell::internal {
namespace {

constexpr double kSupportCell = 0.02;         // metres, of a support
constexpr int kMostCells = 600;               // along each side of a support
constexpr double kOnFace = 0.002;             // metres; lower geoms are part of the face
constexpr double kMostHalfOfContainer = 0.8;  // metres; larger hollows are rooms
constexpr double kLeastShareOfMap = 0.5;      // of a map's free floor, in its house's
constexpr double kSameFloor = 0.1;            // metres between parts of one floor

// Marks the cells of a face that geoms above it cover.
std::vector<bool> TakenCells(const Scene& scene, const Support& face, int nx, int ny) {
  const mjModel* m = scene.model();
  const mjData* d = scene.data();
  std::vector<bool> taken(static_cast<size_t>(nx) * static_cast<size_t>(ny), false);
  const Pose world_to_face = face.frame_to_world.inverse();
  for (int g = 0; g < m->ngeom; ++g) {
    if (!IsCollisionGeom(m, g) || m->geom_type[g] == mjGEOM_PLANE) continue;
    const Eigen::Vector3d middle(d->geom_xpos + 3 * g);
    const double radius = m->geom_rbound[g];
    const Eigen::Vector3d at = world_to_face * middle;
    if (std::abs(at.x()) > face.half_x + radius || std::abs(at.y()) > face.half_y + radius ||
        at.z() + radius < 0 || at.z() - radius > kRoomAbove)
      continue;
    const Pose geom_to_face =
        world_to_face * Pose::FromTranslationAndMatrix(d->geom_xpos + 3 * g, d->geom_xmat + 9 * g);
    Eigen::AlignedBox3d box;
    const mjtNum* aabb = m->geom_aabb + 6 * g;
    for (int corner = 0; corner < 8; ++corner) {
      Eigen::Vector3d point(aabb[0], aabb[1], aabb[2]);
      for (int axis = 0; axis < 3; ++axis)
        point[axis] += (corner >> axis & 1 ? 1 : -1) * aabb[3 + axis];
      box.extend(geom_to_face * point);
    }
    if (box.max().z() < kOnFace || box.min().z() > kRoomAbove) continue;
    const auto cell = [](double value, double half, int count, bool up) {
      const double at = (value + half) / (2 * half) * count;
      return std::clamp(static_cast<int>(up ? std::ceil(at) : std::floor(at)), 0, count);
    };
    for (int j = cell(box.min().y(), face.half_y, ny, false);
         j < cell(box.max().y(), face.half_y, ny, true); ++j) {
      for (int i = cell(box.min().x(), face.half_x, nx, false);
           i < cell(box.max().x(), face.half_x, nx, true); ++i)
        taken[static_cast<size_t>(j) * static_cast<size_t>(nx) + static_cast<size_t>(i)] = true;
    }
  }
  return taken;
}

// Returns the height of the floor under a place: the highest area below, else the lowest of all.
double FloorUnder(const std::vector<FloorArea>& floors, const Eigen::Vector3d& at) {
  double lowest = std::numeric_limits<double>::infinity(), under = -lowest;
  for (const FloorArea& area : floors) {
    const double height = area.frame_to_world.translation().z();
    lowest = std::min(lowest, height);
    if (height <= at.z()) under = std::max(under, height);
  }
  if (std::isfinite(under)) return under;
  return std::isfinite(lowest) ? lowest : 0;
}

// Returns the area that lies lowest of those in rooms of the map, else of all; null without any. Above
// the floor of a room there may be others: the roof over it is one.
const FloorArea* FloorOfRooms(const std::vector<FloorArea>& areas, const HouseMap* map) {
  const FloorArea *lowest = nullptr, *lowest_inside = nullptr;
  const auto is_lower = [](const FloorArea& area, const FloorArea* than) {
    return !than || area.frame_to_world.translation().z() < than->frame_to_world.translation().z();
  };
  for (const FloorArea& area : areas) {
    const Eigen::Vector3d& at = area.frame_to_world.translation();
    if (is_lower(area, lowest)) lowest = &area;
    if (map && !map->RoomNameAt(at.x(), at.y()).empty() && is_lower(area, lowest_inside))
      lowest_inside = &area;
  }
  return lowest_inside ? lowest_inside : lowest;
}

Eigen::Vector3d BodyPosition(const Scene& scene, int body) {
  return Eigen::Vector3d(scene.data()->xpos + 3 * body);
}

// Returns what follows the number in the name of a room: "room_2_living_room" -> "living room"; "" for
// another name.
std::string CategoryOfRoom(const std::string& name) {
  const size_t number = name.find_first_of("0123456789");
  const size_t rest = name.find('_', number);
  if (number == std::string::npos || rest == std::string::npos) return "";
  return WordsOfCategory(name.substr(rest + 1));
}

// Returns the share of some areas that is on the floor of others, by points on a grid. Roofs and tops
// of furniture over them do not count.
double ShareOn(const std::vector<FloorArea>& areas, const std::vector<FloorArea>& others) {
  constexpr int kPoints = 8;  // along each side
  double all = 0, on = 0;
  for (const FloorArea& area : areas) {
    const double each = 4 * area.half_x * area.half_y / (kPoints * kPoints);
    for (int k = 0; k < kPoints * kPoints; ++k) {
      const int row = k / kPoints, column = k % kPoints;
      const Eigen::Vector3d at((2 * column + 1.0) / kPoints - 1, (2 * row + 1.0) / kPoints - 1, 0);
      const Eigen::Vector3d point =
          area.frame_to_world * at.cwiseProduct(Eigen::Vector3d(area.half_x, area.half_y, 0));
      all += each;
      if (std::ranges::any_of(others, [&](const FloorArea& other) {
            const Eigen::Vector3d in = other.frame_to_world.inverse() * point;
            return std::abs(in.x()) <= other.half_x && std::abs(in.y()) <= other.half_y &&
                   std::abs(in.z()) <= kSameFloor;
          }))
        on += each;
    }
  }
  return all > 0 ? on / all : 1;
}

// Reads a file of a house, or notes why there is none.
template <class Read>
auto ReadOrNote(const std::filesystem::path& path, const char* what, const char* instead,
                std::vector<std::string>& notes, Read&& read)
    -> std::optional<decltype(read(path))> {
  if (path.empty()) {
    notes.push_back(fmt::format("it has no {}: {}", what, instead));
    return std::nullopt;
  }
  try {
    return read(path);
  } catch (const Error& error) {
    notes.push_back(fmt::format("{}; {}", error.what(), instead));
    return std::nullopt;
  }
}

}  // namespace

std::vector<SupportFace> FreeSupports(const Scene& scene, const std::vector<SupportFace>& faces) {
  std::vector<SupportFace> free;
  for (const SupportFace& each : faces) {
    const Support& face = each.face;
    const int nx = std::clamp(static_cast<int>(2 * face.half_x / kSupportCell), 1, kMostCells);
    const int ny = std::clamp(static_cast<int>(2 * face.half_y / kSupportCell), 1, kMostCells);
    const double cell_x = 2 * face.half_x / nx, cell_y = 2 * face.half_y / ny;
    std::vector<bool> taken = TakenCells(scene, face, nx, ny);
    const int least = static_cast<int>(std::ceil(kLeastSupport / std::min(cell_x, cell_y)));
    const std::optional<CellRectangle> best = TakeLargest(taken, nx, ny, least);
    if (!best) continue;
    SupportFace part = each;
    const Eigen::Vector3d middle((best->i + best->width / 2.0) * cell_x - face.half_x,
                                 (best->j + best->height / 2.0) * cell_y - face.half_y, 0);
    part.face.frame_to_world = face.frame_to_world * Pose(middle);
    part.face.half_x = best->width * cell_x / 2;
    part.face.half_y = best->height * cell_y / 2;
    part.free_area = 4 * part.face.half_x * part.face.half_y;
    free.push_back(std::move(part));
  }
  std::ranges::stable_sort(free, std::greater<>(), &SupportFace::free_area);
  return free;
}

SceneAnnotations AnnotateHouse(const Scene& scene, const HouseFiles& files,
                               std::vector<std::string>& notes) {
  SceneAnnotations house = DeriveAnnotations(scene);
  std::optional<HouseMap> map =
      ReadOrNote(files.map, "map", "its free floor comes from the geometry, and it has no rooms",
                 notes, ReadHouseMap);
  std::erase_if(house.supports, [&](const SupportFace& support) {
    const Eigen::Vector3d at = support.face.frame_to_world.translation();
    const double height =
        at.z() - FloorUnder(house.free_floor, at - 0.1 * Eigen::Vector3d::UnitZ());
    return height < kLowestFurniture || height > kHighestFurniture;
  });
  house.supports = FreeSupports(scene, house.supports);
  std::erase_if(house.containers, [](const Container& container) {
    return std::ranges::max(container.half_extents) > kMostHalfOfContainer;
  });
  const FloorArea* const lowest = map ? FloorOfRooms(house.free_floor, &*map) : nullptr;
  const double floor_height = lowest ? lowest->frame_to_world.translation().z() : 0;
  std::vector<FloorArea> areas;
  if (map) areas = FreeFloorOf(*map, floor_height);
  // A map of another house, or of another size. A floor that the geometry does not show is in doubt.
  if (const double share = house.free_floor.empty() ? 1 : ShareOn(areas, house.free_floor);
      share < kLeastShareOfMap) {
    notes.push_back(
        fmt::format("its map is not one of this house: only {:.0f} % of its free floor is free; "
                    "the free floor comes from the geometry, and it has no rooms",
                    100 * share));
    map.reset();
  }
  if (map) {
    house.rooms = RoomsOf(*map, floor_height);
    for (Room& room : house.rooms) room.category = CategoryOfRoom(room.name);
    if (!areas.empty()) {
      const std::string floor = lowest ? lowest->floor : "";
      for (FloorArea& area : areas) area.floor = floor;
      house.free_floor = std::move(areas);
    } else {
      notes.emplace_back("its map has no free floor; it comes from the geometry");
    }
    const auto room_at = [&](const Eigen::Vector3d& at) { return map->RoomNameAt(at.x(), at.y()); };
    for (SupportFace& support : house.supports)
      support.room = room_at(support.face.frame_to_world.translation());
    for (Container& container : house.containers)
      container.room = room_at(container.frame_to_world.translation());
  }
  int ignored = 0;
  const std::optional<HouseMetadata> metadata = ReadOrNote(
      files.metadata, "metadata", "its objects have no words", notes,
      [&](const std::filesystem::path& path) { return ReadHouseMetadata(path, &ignored); });
  if (!metadata) return house;
  if (ignored > 0)
    notes.push_back(fmt::format("{} entries of its metadata have an unknown form", ignored));
  for (const auto& [name, object] : metadata->objects) {
    const int body = FindId(scene.model(), mjOBJ_BODY, name);
    if (body < 0) continue;  // left out, or part of another variant
    ObjectWords words{.object = name, .category = object.category, .words = object.words};
    if (words.words.empty() && !object.category.empty())
      words.words = {WordsOfCategory(object.category)};
    const Eigen::Vector3d at = BodyPosition(scene, body);
    if (map) words.room = map->RoomNameAt(at.x(), at.y());
    if (words.room.empty() && object.room) words.room = fmt::format("room_{}", *object.room);
    house.objects.push_back(std::move(words));
  }
  return house;
}

}  // namespace robocell::internal
