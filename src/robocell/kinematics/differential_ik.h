// Differential inverse kinematics: joint velocities for a twist of the tip, within limits.
//
//   const DifferentialIkResult now = DifferentialIk(chain, q, twist, {.seconds = 0.002});
//   for (int i = 0; i < n; ++i) q[i] += 0.002 * now.velocity[i];
//
// The velocity v minimises (J v - twist)^T D^-1 (J v - twist) + |v - v_posture|^2 between its
// bounds, exactly: a joint at its bound leaves its share to the others (P. B. Stark and R. L.
// Parker, "Bounded-Variable Least-Squares", 1995). Lengths are weighed against angles by the
// chain's length, unless another one is given; those that slides move always by the chain's. The
// damping D is negligible, except along directions in which the joints that are not at a bound have
// come near a singularity, where it grows (A. A. Maciejewski and C. A. Klein, "Numerical Filtering
// for the Operation of Robotic Manipulators through Kinematically Singular Configurations", 1988):
// there speeds stay bounded, and the tip lags behind; in all other directions it follows the twist.
//
// No allocation; some microseconds. Throws ArgumentError, with the name, for wrong numbers of
// values and for values that are not finite or out of range.
#pragma once

#include "robocell/kinematics/chain.h"
#include "robocell/kinematics/ik.h"
#include "robocell/math/twist.h"

namespace robocell {

// The axes of a twist of the tip. Its reference point is the tip.
enum class TwistFrame { kBase, kTip, kWorld };

struct DifferentialIkOptions {
  TwistFrame frame = TwistFrame::kBase;
  // Rotation of the base in the world; for TwistFrame::kWorld.
  Eigen::Matrix3d base_in_world = Eigen::Matrix3d::Identity();
  // Duration of the velocity, s: no joint leaves its limits in this time, and one beyond them comes
  // back. 0: positions are ignored.
  double seconds = 0;
  // Largest speed of each joint, rad/s or m/s, above 0. Empty: any.
  JointVector max_speed{};
  // Posture of redundant joints, and their rate: a share of the distance per second. Empty: they
  // rest.
  JointVector posture{};
  double posture_rate = 1;
  // Joints that do not move.
  LockedJoints locked{};
  // The metres that count as much as one radian in the difference from the twist: where it cannot
  // be followed, a small length keeps to its translation. 0: the chain's length.
  double length = 0;
};

struct DifferentialIkResult {
  JointVector velocity{};  // rad/s or m/s
  // The resulting twist of the tip, in the requested axes; and whether bounds or damping make it
  // differ from the target twist by more than a thousandth (and noticeably).
  Twist twist{};
  bool slower = false;
};

DifferentialIkResult DifferentialIk(const Chain& chain, std::span<const double> q,
                                    const Twist& twist, const DifferentialIkOptions& options = {});

}  // namespace robocell
