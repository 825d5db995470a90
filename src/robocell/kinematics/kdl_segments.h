// The segments of a chain in KDL's terms, without KDL's types: the intermediate form between a
// chain and KDL::Chain or PyKDL.Chain.
//
// There is one segment per joint, with the name of the body that the joint moves (of the joint, if
// a body has several) and the body's frame; then, unless the last body's frame already is the tip,
// a fixed segment named like the tip. Joint values are those of the model (mjData.qpos), also where
// its reference positions are not 0. Inertias are those of Chain: everything that hangs on a link,
// in true masses, because KDL has no gravity compensation.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "robocell/kinematics/chain.h"
#include "robocell/kinematics/transform.h"

namespace robocell {

// All values are in the frame of the previous segment; for the first one in the base frame.
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
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();   // centre of mass, m
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  // about the centre of mass, kg m^2
};

std::vector<KdlSegment> KdlSegments(const Chain& chain);

// Makes a chain from segments. The base is called "base", the tip is the last segment. Fixed
// segments join the previous link; those before the first joint do not move and are left out. KDL
// keeps no limits: `limits` has {lower, upper} of each moving joint in order, or nothing. Throws
// ArgumentError if no joint moves, there are more than kMaxChainJoints, or the limits do not fit.
Chain ChainFromSegments(const std::vector<KdlSegment>& segments,
                        std::span<const std::array<double, 2>> limits = {});

// Sets `offset` from KDL's description of a joint: the joint's pose for joint value 0, and its
// speed along its axis for a joint speed of 1. Throws ArgumentError for another speed than 1, which
// a chain does not support.
void SetOffset(const Transform& pose_at_zero, double speed, KdlSegment* segment);
// Sets the inertia from the one about the segment's origin, as KDL has it, instead of that about
// the centre.
void SetInertiaAboutOrigin(const Eigen::Matrix3d& inertia, KdlSegment* segment);

}  // namespace robocell
