// FloorWays: ways over the floor of a scene for a robot with a planar base (motion/floor_map.h).
//
//   FloorWays ways(robot);
//   const auto way = ways.FindWay(ways.PlacesBeside(area, 1, nullptr));
//
// Everything that collides between the base's plane and the top of the robot is an obstacle; the
// robot's geoms count at their heading, in its present posture. Places are those of the base's drive
// frame in the world (robot/planar_motion.h).
#pragma once

#include <optional>
#include <span>
#include <vector>
#include <Eigen/Geometry>

#include "robocell/math/pose.h"
#include "robocell/motion/floor_map.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"
#include "robocell/scenes/scene_annotations.h"
#include "robocell/task/base_stances.h"

namespace robocell::internal {

inline constexpr double kWayClearance = 0.04;  // metres beside a way

// Returns the place of a robot's base, and the pose of a base at a place: upright, at `height`.
FloorPlace PlaceOf(const Pose& base);
Pose PoseOf(const FloorPlace& place, double height);

// Returns the rectangle in the world around a body's collision geoms; around its origin without any.
Eigen::AlignedBox2d FootprintOf(const Scene& scene, int body);

bool IsInRoom(const Room& room, const Eigen::Vector2d& at);

class FloorWays {
 public:
  // Reads the scene, whose poses are up to date; after changes, make another. Throws ArgumentError
  // for a robot whose base does not move in a plane.
  explicit FloorWays(const Robot& robot);
  FloorWays(const FloorWays&) = delete;  // the map asks the stances
  FloorWays& operator=(const FloorWays&) = delete;

  // Returns free places at which the base faces the middle of the area within a distance of it, in
  // `room` if that is set, nearest to the area first; at most `most`.
  std::vector<FloorPlace> PlacesBeside(const Eigen::AlignedBox2d& area, double within,
                                       const Room* room, size_t most = 24);
  // Returns free places in a room, at several headings, those with the most room first.
  std::vector<FloorPlace> PlacesIn(const Room& room, size_t most = 24);
  // Returns those of these places of the base at which the robot is free, in the drive frame.
  std::vector<FloorPlace> FreeOf(std::span<const FloorPlace> bases);
  // Returns a way from the present place to the one of these that is nearest by way.
  std::optional<std::vector<FloorPlace>> FindWay(std::span<const FloorPlace> goals);

 private:
  Robot robot_;
  Pose drive_frame_;
  double height_;  // of the base's plane
  BaseStances stances_;
  FloorMap map_;
};

}  // namespace robocell::internal
