// Support: the level surface of a scene for its objects.
//
//   const Support support = FindSupport(base);   // a SceneSpec
//   Pose on_top = support.frame_to_world * Pose(Eigen::Vector3d(x, y, 0));   // |x| < half_x ...
#pragma once

#include <string>
#include <vector>

#include "robocell/math/pose.h"
#include "robocell/motion/robot_outline.h"
#include "robocell/scene/scene.h"
#include "robocell/spec/scene_spec.h"

namespace robocell {

// A rectangle: its centre, z up, and half extents along its x and y; the depth of its body. Metres.
struct Support {
  Pose frame_to_world;
  double half_x = 0, half_y = 0;
  double thickness = 0;
  LevelBox box() const { return {frame_to_world, half_x, half_y, thickness}; }
  std::string moved_body = {};  // the moving body that carries it; "" for a fixed support
};

// The support of a base scene: the largest level upper face of a box that stands still, has 0.3 m
// of room above its middle, and is as high as furniture is (0.15 to 1.6 m), if there is such a one;
// else of any height; without any such face a free part of a level floor, 1 m wide at most.
// Nothing needs a site `table_top`: with one, the scene's author chooses another support (or with the
// only site that has that name behind a prefix, as `shop_table_top` or `shop/table_top`): the largest
// box in the site's body is its extent, a
// horizontal face of it, in whatever pose the box is in its body, with the site on it. Objects that
// are parked have no support to offer.
// NotFoundError without face and floor, SpecError with several sites that could be meant, without a
// box or when the site is not on the box's upper face or the face is not level.
Support FindSupport(const SceneSpec& base);

// Level planes, on which objects may stand where no face has room for them. An endless one extends
// by `reach` beyond the point `around`.
std::vector<Support> FindFloors(const Scene& scene, const Eigen::Vector3d& around, double reach);

struct SupportFace;
// All level upper faces of boxes that stand still and have room above, the one that FindSupport
// takes first, the others from the largest on.
std::vector<SupportFace> FindSupportFaces(const Scene& scene);

// SpecError when the support of this scene does not stay where it is: a table with a free joint
// that stands on nothing takes along what is put on it.
void RequireSteady(const SceneSpec& base, const Support& support);

}  // namespace robocell
