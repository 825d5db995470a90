#include "robocell/scenes/houses/floor_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numeric>

namespace robocell::internal {
namespace {

constexpr double kLeastRoomSide = 2.6;  // metres, of a room up to the middles of its walls
constexpr double kDoorMargin = 0.25;    // between a door and the end of its wall
constexpr double kLeastWindowWall = 1.8;
constexpr double kExtraDoor = 0.3;  // chance of a door more than is needed
constexpr double kGrid = 0.05;      // lengths are multiples of it

double Rounded(double length) { return std::round(length / kGrid) * kGrid; }

using Rectangle = Eigen::AlignedBox2d;

// Splits the largest part until there are enough.
std::vector<Rectangle> Split(const Rectangle& outline, int count, Rng& rng) {
  std::vector<Rectangle> parts = {outline};
  while (static_cast<int>(parts.size()) < count) {
    const auto largest = std::ranges::max_element(parts, {}, &Rectangle::volume);
    const Rectangle part = *largest;
    const int axis = part.sizes().x() >= part.sizes().y() ? 0 : 1;
    const double length = part.sizes()[axis];
    if (length < 2 * kLeastRoomSide) break;
    const double share = rng.Uniform(0.42, 0.58);
    const double at = part.min()[axis] +
                      std::clamp(Rounded(length * share), kLeastRoomSide, length - kLeastRoomSide);
    Rectangle low = part, high = part;
    low.max()[axis] = at;
    high.min()[axis] = at;
    *largest = low;
    parts.push_back(high);
  }
  return parts;
}

// Returns the walls of all rooms: one for each pair of neighbours, and the outer ones.
std::vector<PlanWall> WallsOf(const std::vector<PlanRoom>& rooms, const Rectangle& outline) {
  std::vector<PlanWall> walls;
  constexpr double kSame = 1e-6;
  for (const int axis : {0, 1}) {  // walls along x, then along y
    const int across = 1 - axis;
    const auto add = [&](double at, double from, double to, int below, int above) {
      if (to - from < kSame) return;
      PlanWall wall{.length = to - from, .along_x = axis == 0, .below = below, .above = above};
      wall.start[axis] = from;
      wall.start[across] = at;
      walls.push_back(std::move(wall));
    };
    for (size_t i = 0; i < rooms.size(); ++i) {
      const Rectangle& a = rooms[i].outer;
      if (a.min()[across] - outline.min()[across] < kSame)
        add(a.min()[across], a.min()[axis], a.max()[axis], -1, static_cast<int>(i));
      if (outline.max()[across] - a.max()[across] < kSame)
        add(a.max()[across], a.min()[axis], a.max()[axis], static_cast<int>(i), -1);
      for (size_t j = 0; j < rooms.size(); ++j) {
        const Rectangle& b = rooms[j].outer;
        if (std::abs(a.max()[across] - b.min()[across]) > kSame) continue;
        add(a.max()[across], std::max(a.min()[axis], b.min()[axis]),
            std::min(a.max()[axis], b.max()[axis]), static_cast<int>(i), static_cast<int>(j));
      }
    }
  }
  return walls;
}

bool HasRoomForDoor(const PlanWall& wall) { return wall.length >= kDoorWidth + 2 * kDoorMargin; }

void AddDoor(PlanWall& wall, Rng& rng) {
  const double margin = kDoorMargin + kDoorWidth / 2;
  const double at = Rounded(rng.Uniform(margin, wall.length - margin));
  // Doors of outer walls open to the inside.
  const bool up = wall.below < 0 || (wall.above >= 0 && rng.Uniform(0, 1) < 0.5);
  wall.openings.push_back({.is_door = true,
                           .at = std::clamp(at, margin, wall.length - margin),
                           .width = kDoorWidth,
                           .opens_up = up,
                           .hinge_at_start = rng.Uniform(0, 1) < 0.5});
}

// Connects all rooms, and the first one with the outside.
void AddDoors(FloorPlan& plan, Rng& rng) {
  std::vector<int> group(plan.rooms.size());
  std::iota(group.begin(), group.end(), 0);
  const std::function<int(int)> root = [&](int room) {
    return group[static_cast<size_t>(room)] == room ? room : root(group[static_cast<size_t>(room)]);
  };
  std::vector<size_t> order(plan.walls.size());
  std::iota(order.begin(), order.end(), size_t{0});
  rng.Shuffle(order);
  bool has_entrance = false;
  for (const size_t i : order) {
    PlanWall& wall = plan.walls[i];
    if (!HasRoomForDoor(wall)) continue;
    if (wall.below < 0 || wall.above < 0) {
      if (has_entrance || std::max(wall.below, wall.above) != 0) continue;
      has_entrance = true;
      AddDoor(wall, rng);
      continue;
    }
    const int a = root(wall.below), b = root(wall.above);
    if (a == b && rng.Uniform(0, 1) > kExtraDoor) continue;
    group[static_cast<size_t>(a)] = b;
    AddDoor(wall, rng);
  }
  int count = 0;
  for (PlanWall& wall : plan.walls) {
    for (PlanOpening& opening : wall.openings)
      opening.name = fmt::format("door_{}_0_{}", ++count, std::max(wall.below, wall.above) + 1);
  }
}

void AddWindows(FloorPlan& plan, Rng& rng) {
  for (PlanWall& wall : plan.walls) {
    const bool is_outer = wall.below < 0 || wall.above < 0;
    if (!is_outer || wall.length < kLeastWindowWall || !wall.openings.empty()) continue;
    if (rng.Uniform(0, 1) > 0.75) continue;
    const double width = Rounded(std::min(rng.Uniform(1.0, 1.8), wall.length - 0.8));
    wall.openings.push_back({.at = wall.length / 2, .width = width});
  }
}

RoomKind DrawKind(size_t room, const PlanOptions& options, Rng& rng) {
  if (room < options.kinds.size()) return options.kinds[room];
  // The first rooms are those that a house has.
  static constexpr RoomKind kHome[] = {RoomKind::kLiving, RoomKind::kKitchen, RoomKind::kBedroom};
  if (options.kinds.empty() && room < std::size(kHome)) return kHome[room];
  static constexpr RoomKind kMore[] = {RoomKind::kOffice, RoomKind::kBedroom, RoomKind::kWorkshop,
                                       RoomKind::kOffice, RoomKind::kWarehouse};
  return kMore[rng.UniformInt(std::size(kMore))];
}

}  // namespace

std::string_view NameOf(RoomKind kind) {
  for (const auto& [each, name] : kRoomKinds) {
    if (each == kind) return name;
  }
  return "room";
}

FloorPlan MakeFloorPlan(const PlanOptions& options, Rng& rng) {
  const int count = std::max(1, options.rooms);
  const double area = count * rng.Uniform(14.0, 18.0);
  const double aspect = rng.Uniform(1.0, 1.5);
  const double length = std::max(Rounded(std::sqrt(area * aspect)), kLeastRoomSide + 0.6);
  const double width = std::max(Rounded(area / length), kLeastRoomSide + 0.4);
  FloorPlan plan;
  plan.outline = Rectangle(Eigen::Vector2d(0, 0), Eigen::Vector2d(length, width));
  std::vector<Rectangle> parts = Split(plan.outline, count, rng);
  std::ranges::stable_sort(parts, std::greater<>(), &Rectangle::volume);
  for (size_t i = 0; i < parts.size(); ++i) {
    const RoomKind kind = DrawKind(i, options, rng);
    plan.rooms.push_back(
        {.kind = kind, .name = fmt::format("room_{}_{}", i + 1, NameOf(kind)), .outer = parts[i]});
  }
  plan.walls = WallsOf(plan.rooms, plan.outline);
  AddDoors(plan, rng);
  AddWindows(plan, rng);
  return plan;
}

}  // namespace robocell::internal
