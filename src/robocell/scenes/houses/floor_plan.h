// FloorPlan: rooms, walls with doors and windows of a generated house, on one level. The house is a
// rectangle that is split into rooms; doors connect all of them.
//
//   Rng rng({seed, "plan"});
//   const FloorPlan plan = MakeFloorPlan({.rooms = 4}, rng);
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>
#include <Eigen/Geometry>

#include "robocell/base/rng.h"

namespace robocell::internal {

enum class RoomKind { kKitchen, kLiving, kBedroom, kOffice, kWorkshop, kWarehouse };
inline constexpr std::array kRoomKinds = {
    std::pair{RoomKind::kKitchen, "kitchen"},   std::pair{RoomKind::kLiving, "living_room"},
    std::pair{RoomKind::kBedroom, "bedroom"},   std::pair{RoomKind::kOffice, "office"},
    std::pair{RoomKind::kWorkshop, "workshop"}, std::pair{RoomKind::kWarehouse, "warehouse"}};
std::string_view NameOf(RoomKind kind);

inline constexpr double kWallThickness = 0.12, kWallHeight = 2.5;  // metres
inline constexpr double kDoorWidth = 0.9, kDoorHeight = 2.05;
inline constexpr double kWindowSill = 0.95, kWindowHead = 2.1;

struct PlanRoom {
  RoomKind kind;
  std::string name;           // "room_1_kitchen"
  Eigen::AlignedBox2d outer;  // up to the middles of its walls
  Eigen::AlignedBox2d inner() const {
    const Eigen::Vector2d half = Eigen::Vector2d::Constant(kWallThickness / 2);
    return {outer.min() + half, outer.max() - half};
  }
};

// An opening of a wall.
struct PlanOpening {
  bool is_door = false;
  double at = 0, width = 0;  // its middle from the start of the wall
  bool opens_up = true;      // a door opens towards the room on the larger side
  bool hinge_at_start = true;
  std::string name = {};  // of a door: "door_1_0_2"
};

// A straight wall along x or y, from `start`; it stands between two rooms, or is an outer wall.
struct PlanWall {
  Eigen::Vector2d start = Eigen::Vector2d::Zero();
  double length = 0;
  bool along_x = true;
  int below = -1, above = -1;  // rooms on the side of smaller and larger y or x; -1 is outside
  std::vector<PlanOpening> openings = {};
  Eigen::Vector2d at(double distance) const {
    return start + distance * (along_x ? Eigen::Vector2d::UnitX() : Eigen::Vector2d::UnitY());
  }
  Eigen::Vector2d up() const {
    return along_x ? Eigen::Vector2d::UnitY() : Eigen::Vector2d::UnitX();
  }
};

struct FloorPlan {
  Eigen::AlignedBox2d outline;  // the middles of the outer walls
  std::vector<PlanRoom> rooms;
  std::vector<PlanWall> walls;
};

struct PlanOptions {
  int rooms = 4;
  std::vector<RoomKind> kinds = {};  // of the rooms, largest first; the rest is drawn
};

FloorPlan MakeFloorPlan(const PlanOptions& options, Rng& rng);

}  // namespace robocell::internal
