// LevelArea: a level rectangle, such as a table top, a part of a floor or the bottom of a drawer. A
// Support (scenes/support.h) and a FloorArea (scenes/scene_annotations.h) are areas of a scene with
// what is known of them.
//
//   const LevelArea top{.frame_to_world = pose, .half_x = 0.4, .half_y = 0.3};
//   const Eigen::Vector3d corner = top.frame_to_world * Eigen::Vector3d(top.half_x, top.half_y, 0);
#pragma once

#include "robocell/math/pose.h"

namespace robocell {

// Metres.
struct LevelArea {
  Pose frame_to_world = {};       // of its middle, z up
  double half_x = 0, half_y = 0;  // half extents along its x and y; 0 for a spot
  double thickness = 0;           // depth of the box below, if it is the top of one
};

}  // namespace robocell
