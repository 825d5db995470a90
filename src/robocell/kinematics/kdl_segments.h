// The segments of a chain in KDL's terms, without KDL's types: what KDL::Chain and PyKDL.Chain are
// made from, and chains from them.
//
// One segment per joint, named as the body that the joint moves (as the joint, where a body has
// several), whose frame is the body's; then, unless the last body's frame is the tip already, a
// fixed segment named as the tip. Joint values are those of the model (mjData.qpos), also where its
// reference positions are not 0. Inertias are those of Chain: everything that hangs on a link, in
// true masses; gravity compensation is unknown to KDL.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "robocell/kinematics/chain.h"
#include "robocell/kinematics/transform.h"

namespace robocell {

// Everything in the frame of the segment before; for the first one in the base frame.
struct KdlSegment {
  enum class Motion { kFixed, kRotate, kSlide };

  std::string name;
  std::string joint;  // "" when fixed
  Motion motion = Motion::kFixed;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // a point on the joint's axis, m
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  double offset = 0;    // added to the joint value, rad or m
  double armature = 0;  // kg m^2 or kg
  Transform tip = {};   // the segment's frame for joint value 0
  // Inertia of the segment, in its own frame.
  double mass = 0;                                    // kg
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();   // of mass, m
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  // about the centre of mass, kg m^2
};

std::vector<KdlSegment> KdlSegments(const Chain& chain);

// The way back. The base is called "base", the tip is the last segment. Fixed segments join the
// link before them; what hangs before the first joint does not move and is left out. KDL keeps no
// limits: `limits` has {lower, upper} of each moving joint in order, or nothing. ArgumentError when
// no joint moves, there are more than kMaxChainJoints, or the limits do not fit.
Chain ChainFromSegments(const std::vector<KdlSegment>& segments,
                        std::span<const std::array<double, 2>> limits = {});

// What KDL says of a joint in its own way: the joint's pose for joint value 0, and how fast it
// moves along its axis for a joint speed of 1. Sets `offset`. ArgumentError for another speed than
// 1, which a chain does not have.
void SetOffset(const Transform& pose_at_zero, double speed, KdlSegment* segment);
// The inertia about the segment's origin, where KDL has it, instead of that about the centre.
void SetInertiaAboutOrigin(const Eigen::Matrix3d& inertia, KdlSegment* segment);

}  // namespace robocell
