// Chains, poses and joint values as Orocos KDL knows them. The only header of robocell that
// includes KDL.
//
// What is in the chain is said in kdl_segments.h.
//
//   KDL::Chain chain = ToKdl(robocell_chain);
//   KDL::ChainFkSolverPos_recursive fk(chain);
#pragma once

#include <kdl/chain.hpp>
#include <kdl/frames.hpp>
#include <kdl/jntarray.hpp>

#include <span>

#include "robocell/kinematics/chain.h"
#include "robocell/math/pose.h"

namespace robocell {

KDL::Chain ToKdl(const Chain& chain);

KDL::Frame ToKdl(const Pose& pose);
Pose FromKdl(const KDL::Frame& frame);
KDL::JntArray ToKdl(std::span<const double> q);

}  // namespace robocell
