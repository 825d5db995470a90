#include "robocell/task/floor_ways.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "robocell/base/error.h"
#include "robocell/base/units.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/robot/planar_motion.h"
#include "robocell/scenes/free_floor.h"
#include "robocell/scenes/free_rectangles.h"

namespace robocell::internal {
namespace {

constexpr double kLowestObstacle = 0.02;  // metres; the base drives over lower geoms
constexpr double kFloorMargin = 1;        // metres of floor around everything
constexpr double kMostFloorHalf = 25;     // of the floor, metres

const PlanarMotion& MotionOf(const Robot& robot) {
  if (const PlanarMotion* motion = PlanarMotion::Of(robot.base())) return *motion;
  throw ArgumentError("robot '" + robot.name() +
                      "' does not move over the floor. Give it `base: {kind: planar}`");
}

// What the robot takes up around the origin of its drive frame.
struct FloorExtent {
  double radius = 0, height = 0;  // metres; height above the plane
};

FloorExtent FloorExtentOf(const Robot& robot, const Eigen::Vector3d& base) {
  const mjModel* m = robot.scene().model();
  const mjData* d = robot.scene().data();
  FloorExtent extent;
  for (const int g : robot.collision_geom_ids()) {
    if (!IsCollisionGeom(m, g)) continue;
    for (const Eigen::Vector3d& corner : BoxCornersOf(m, d, g)) {
      extent.radius = std::max(extent.radius, (corner - base).head<2>().norm());
      extent.height = std::max(extent.height, corner.z() - base.z());
    }
  }
  return extent;
}

FloorMap FloorMapOf(const Robot& robot, const Pose& drive_frame, BaseStances& stances) {
  const mjModel* m = robot.scene().model();
  const mjData* d = robot.scene().data();
  const Eigen::Vector3d base = (robot.base().pose() * drive_frame).translation();
  const FloorExtent extent = FloorExtentOf(robot, base);
  std::vector<char> own(static_cast<size_t>(m->ngeom), 0);
  for (const int g : robot.geom_ids()) own[static_cast<size_t>(g)] = 1;
  Eigen::AlignedBox2d bounds(base.head<2>());
  std::vector<std::vector<Eigen::Vector2d>> outlines;
  for (int g = 0; g < m->ngeom; ++g) {
    if (own[static_cast<size_t>(g)] || !IsCollisionGeom(m, g) || m->geom_type[g] == mjGEOM_PLANE)
      continue;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    std::vector<Eigen::Vector2d> points;
    for (const Eigen::Vector3d& corner : BoxCornersOf(m, d, g)) {
      low = std::min(low, corner.z() - base.z());
      high = std::max(high, corner.z() - base.z());
      points.emplace_back(corner.x(), corner.y());
    }
    for (const Eigen::Vector2d& point : points) bounds.extend(point);
    if (high > kLowestObstacle && low < extent.height)
      outlines.push_back(ConvexHull(std::move(points)));
  }
  bounds.min() = (bounds.min().array() - kFloorMargin).max(base.head<2>().array() - kMostFloorHalf);
  bounds.max() = (bounds.max().array() + kFloorMargin).min(base.head<2>().array() + kMostFloorHalf);
  const double height = base.z();
  FloorMap map({.bounds = bounds,
                .radius = extent.radius + kWayClearance,
                .drives_sideways = MotionOf(robot).drives_sideways()},
               [&stances, height, to_base = drive_frame.inverse()](const FloorPlace& place) {
                 const Pose pose = PoseOf(place, height) * to_base;
                 return bool{stances.AreFree({&pose, 1}).front()};
               });
  for (const auto& outline : outlines) map.Block(outline);
  return map;
}

}  // namespace

FloorPlace PlaceOf(const Pose& base) {
  const Eigen::Vector3d ahead = base.rotation().col(0);
  return {base.translation().x(), base.translation().y(), std::atan2(ahead.y(), ahead.x())};
}

Pose PoseOf(const FloorPlace& place, double height) {
  return Pose::FromRpy({place.x, place.y, height}, {0, 0, place.yaw});
}

Eigen::AlignedBox2d FootprintOf(const Scene& scene, int body) {
  const mjModel* m = scene.model();
  const mjData* d = scene.data();
  Eigen::AlignedBox2d area;
  for (const int g : CollisionGeomsOf(m, body))
    for (const Eigen::Vector3d& corner : BoxCornersOf(m, d, g))
      area.extend(Eigen::Vector2d(corner.head<2>()));
  if (area.isEmpty()) area.extend(Eigen::Vector2d(d->xpos[3 * body], d->xpos[3 * body + 1]));
  return area;
}

bool IsInRoom(const Room& room, const Eigen::Vector2d& at) {
  // A ray along x crosses the outline an odd number of times.
  bool inside = false;
  const size_t n = room.outline.size();
  for (size_t i = 0; i < n; ++i) {
    const auto& [ax, ay] = room.outline[i];
    const auto& [bx, by] = room.outline[(i + 1) % n];
    if ((ay > at.y()) == (by > at.y())) continue;
    if (at.x() < ax + (bx - ax) * (at.y() - ay) / (by - ay)) inside = !inside;
  }
  return inside;
}

FloorWays::FloorWays(const Robot& robot)
    : robot_(robot),
      drive_frame_(MotionOf(robot).drive_frame()),
      height_(robot.base().pose().translation().z()),
      stances_(robot, kWayClearance),
      map_(FloorMapOf(robot, drive_frame_, stances_)) {}

std::vector<FloorPlace> FloorWays::FreeOf(std::span<const FloorPlace> bases) {
  std::vector<Pose> poses;
  for (const FloorPlace& base : bases) poses.push_back(PoseOf(base, height_));
  const std::vector<bool> free = stances_.AreFree(poses);
  std::vector<FloorPlace> left;
  for (size_t i = 0; i < bases.size(); ++i)
    if (free[i]) left.push_back(PlaceOf(poses[i] * drive_frame_));
  return left;
}

std::vector<FloorPlace> FloorWays::PlacesBeside(const Eigen::AlignedBox2d& area, double within,
                                                const Room* room, size_t most) {
  constexpr int kPlaceBearings = 32, kSteps = 4;
  const Eigen::Vector2d middle = area.center();
  std::vector<FloorPlace> places;
  // Rings around the area, from near to far.
  for (int step = 1; step <= kSteps; ++step) {
    const double distance = 0.9 * within * step / kSteps;
    for (int b = 0; b < kPlaceBearings; ++b) {
      const double bearing = 2 * kPi * b / kPlaceBearings;
      const Eigen::Vector2d out(std::cos(bearing), std::sin(bearing));
      // From the middle out to the given distance of the rectangle.
      double low = 0, high = area.diagonal().norm() + distance;
      for (int halving = 0; halving < 30; ++halving) {
        const double mid = (low + high) / 2;
        (area.exteriorDistance(Eigen::Vector2d(middle + mid * out)) < distance ? low : high) = mid;
      }
      const Eigen::Vector2d at = middle + low * out;
      if (room && !IsInRoom(*room, at)) continue;
      places.push_back({at.x(), at.y(), std::remainder(bearing + kPi, 2 * kPi)});
    }
  }
  places = FreeOf(places);
  if (places.size() > most) places.resize(most);
  return places;
}

std::vector<FloorPlace> FloorWays::PlacesIn(const Room& room, size_t most) {
  constexpr double kStep = 0.25;  // metres between places
  Eigen::AlignedBox2d box;
  for (const auto& [x, y] : room.outline) box.extend(Eigen::Vector2d(x, y));
  std::vector<FloorPlace> places;
  for (double x = box.min().x() + kStep / 2; x < box.max().x(); x += kStep) {
    for (double y = box.min().y() + kStep / 2; y < box.max().y(); y += kStep) {
      if (!IsInRoom(room, {x, y})) continue;
      for (int quarter = 0; quarter < 4; ++quarter) places.push_back({x, y, quarter * kPi / 2});
    }
  }
  places = FreeOf(places);
  std::ranges::stable_sort(places, [&](const FloorPlace& a, const FloorPlace& b) {
    return map_.RoomAt(a.x, a.y) > map_.RoomAt(b.x, b.y);
  });
  if (places.size() > most) places.resize(most);
  return places;
}

std::optional<std::vector<FloorPlace>> FloorWays::FindWay(std::span<const FloorPlace> goals) {
  return map_.FindWay(PlaceOf(robot_.base().pose() * drive_frame_), goals);
}

}  // namespace robocell::internal
