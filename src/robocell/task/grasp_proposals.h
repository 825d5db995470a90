// Proposals of grasps by the geometry of the object and the sizes of the hand, before the hand's real
// geometry is checked (grasp_generator.h).
#pragma once

#include <vector>
#include <Eigen/Core>

#include "robocell/base/rng.h"
#include "robocell/task/convex_solid.h"
#include "robocell/task/grasp.h"
#include "robocell/task/grasp_generator.h"
#include "robocell/task/hand_geometry.h"

namespace robocell::internal {

// What is grasped, in the frame of its body.
struct GraspTarget {
  BodySolids all;               // the body and what is rigidly fixed to it
  BodySolids wanted;            // the geoms to grasp
  std::vector<char> is_wanted;  // per geom of the model
  std::vector<char> is_handle;  // per geom, by its name
  Eigen::Vector3d com = Eigen::Vector3d::Zero();
};

// A proposal with the gap at which the fingers nearly touch.
struct GraspProposal {
  Grasp grasp;
  double gap_before = 0;  // m: the hand must be free at this gap too
  double press = 0;       // m that it may be inside the object at contact
};

// Proposes grasps between two fingers, or the first finger and the others.
std::vector<GraspProposal> ProposeTwoFingerGrasps(const GraspTarget& target,
                                                  const HandGeometry& hand,
                                                  const GraspOptions& options, Rng rng);
// Proposes places of a hand with three fingers or more around the object.
std::vector<GraspProposal> ProposeEnclosingGrasps(const GraspTarget& target,
                                                  const HandGeometry& hand,
                                                  const GraspOptions& options, Rng rng);
std::vector<GraspProposal> ProposeSuctionGrasps(const GraspTarget& target, const HandGeometry& hand,
                                                const GraspOptions& options, Rng rng);
std::vector<GraspProposal> ProposePushes(const GraspTarget& target, const HandGeometry& hand,
                                         const GraspOptions& options, Rng rng);
std::vector<GraspProposal> ProposeHooks(const GraspTarget& target, const HandGeometry& hand,
                                        const GraspOptions& options, Rng rng);

// Returns the rotation whose columns are x, y and z = y cross... of a grasp frame.
inline Eigen::Matrix3d GraspAxes(const Eigen::Vector3d& closing, const Eigen::Vector3d& approach) {
  Eigen::Matrix3d axes;
  axes << closing.cross(approach), closing, approach;
  return axes;
}

}  // namespace robocell::internal
