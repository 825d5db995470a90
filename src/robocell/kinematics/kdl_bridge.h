// Chains, poses and joint values as Orocos KDL knows them. The only header of robocell that
// includes KDL.
//
// The KDL chain has one segment per joint, named as the body that the joint moves (as the joint,
// where a body has several), whose frame is the body's; then, unless the last body's frame is the
// tip already, a fixed segment named as the tip. Joint values are those of the model (mjData.qpos),
// also where its reference positions are not 0. Inertias are those of Chain: everything that hangs
// on a link, in true masses; gravity compensation is unknown to KDL.
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
