// Rotations as free functions on quaternions (xyzw) and 3x3 matrices. A rotation with a position is
// a Pose (math/pose.h).
//
// Angles are radians. A quaternion here is of unit length, and results are in canonical form: w >
// 0, or w = 0 and the first non-zero number of x, y, z positive; so q and -q, the same rotation,
// give the same numbers. Only UnitQuaternion and QuaternionFromMatrix check their argument; the
// others take any unit quaternion.
//
// Nothing allocates, and all functions may be called from any thread.
#pragma once

#include <array>

#include <Eigen/Core>

#include "robocell/base/rng.h"

namespace robocell {

// A quaternion in xyzw order: plain storage, so that structs holding it have the same layout under
// all compiler flags.
using Quaternion = std::array<double, 4>;

// Returns the canonical form of a quaternion within 1e-6 of unit length. Throws ArgumentError for
// any other, and for a number that is not finite. It does not change a single bit of the results of
// this file.
Quaternion UnitQuaternion(const Quaternion& q);

Quaternion QuaternionFromWxyz(const double wxyz[4]);  // checked as by UnitQuaternion
Quaternion QuaternionToWxyz(const Quaternion& q);     // MuJoCo's order

// Throws ArgumentError unless the matrix is orthonormal with determinant +1 within 1e-6.
Quaternion QuaternionFromMatrix(const Eigen::Matrix3d& rotation);
Eigen::Matrix3d MatrixFromQuaternion(const Quaternion& q);

// Returns the rotation b followed by a, like the product of matrices.
Quaternion QuaternionProduct(const Quaternion& a, const Quaternion& b);
Quaternion QuaternionInverse(const Quaternion& q);
Eigen::Vector3d Rotate(const Quaternion& q, const Eigen::Vector3d& v);

// Convert a rotation vector (axis * angle) to a quaternion and back. The resulting angle is in [0,
// pi]; both directions are accurate near 0 and near pi.
Quaternion QuaternionFromRotvec(const Eigen::Vector3d& rotvec);
Eigen::Vector3d RotvecFromQuaternion(const Quaternion& q);

// Roll, pitch, yaw: R = Rz(yaw) * Ry(pitch) * Rx(roll). The resulting pitch is in [-pi/2, pi/2],
// and roll is 0 where pitch is +-pi/2 (gimbal lock, where only yaw -+ roll is defined).
Quaternion QuaternionFromRpy(const Eigen::Vector3d& rpy);
Eigen::Vector3d RpyFromQuaternion(const Quaternion& q);

// Returns the angle of the rotation from a to b, in [0, pi].
double AngleBetween(const Quaternion& a, const Quaternion& b);
// Interpolates with constant angular velocity along the shorter arc: a at s = 0, b at s = 1; other
// s continue the motion.
Quaternion Slerp(const Quaternion& a, const Quaternion& b, double s);

// Returns a random orientation; all are equally likely.
Quaternion RandomQuaternion(Rng& rng);

// Returns the matrix S with S * b = a x b.
Eigen::Matrix3d Skew(const Eigen::Vector3d& a);

}  // namespace robocell
