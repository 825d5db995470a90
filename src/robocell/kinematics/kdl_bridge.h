// Converts chains, poses, twists, wrenches and joint values to Orocos KDL and back. The only header
// of robocell that includes KDL.
//
// kdl_segments.h describes the contents of the chain.
//
//   KDL::Chain chain = ToKdl(robot.chain());
//   KDL::ChainFkSolverPos_recursive fk(chain);
//   Chain ours = FromKdl(a_chain_made_elsewhere);
#pragma once

#include <kdl/chain.hpp>
#include <kdl/frames.hpp>
#include <kdl/jntarray.hpp>

#include <array>
#include <span>

#include "robocell/kinematics/chain.h"
#include "robocell/math/pose.h"
#include "robocell/math/twist.h"

namespace robocell {

// KDL knows no joints that follow others: its chain has all joints, and takes chain.Expand(q).
KDL::Chain ToKdl(const Chain& chain);
// Returns a chain with KDL's numbers, for robocell's kinematics and dynamics. Joint damping and
// stiffness are left out. KDL keeps limits beside a chain: `limits` has {lower, upper} of each
// moving joint, or nothing; {-inf, inf} for a joint without limits. Throws ArgumentError for joints
// with a scale, and the errors of ChainFromSegments (kdl_segments.h).
Chain FromKdl(const KDL::Chain& chain, std::span<const std::array<double, 2>> limits = {});

KDL::Frame ToKdl(const Pose& pose);
Pose FromKdl(const KDL::Frame& frame);
KDL::Twist ToKdl(const Twist& twist);
Twist FromKdl(const KDL::Twist& twist);
KDL::Wrench ToKdl(const Wrench& wrench);
Wrench FromKdl(const KDL::Wrench& wrench);
KDL::JntArray ToKdl(std::span<const double> q);
JointVector FromKdl(const KDL::JntArray& q);

}  // namespace robocell
