// Rotations as free functions on quaternions (xyzw) and 3x3 matrices. A rotation with a place is a
// Pose (math/pose.h).
//
// Angles are radians. A quaternion here is of unit length, in its canonical form when it is a
// result: w > 0, or w = 0 and the first non-zero number of x, y, z positive; so q and -q, the same
// rotation, give the same numbers. Only UnitQuaternion and QuaternionFromMatrix check their
// argument; the others take any unit quaternion.
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

// The canonical form of a quaternion within 1e-6 of unit length; any other, or a number that is not
// finite, is an ArgumentError. Does not change a result of this file by a single bit.
Quaternion UnitQuaternion(const Quaternion& q);

Quaternion QuaternionFromWxyz(const double wxyz[4]);  // checked as by UnitQuaternion
Quaternion QuaternionToWxyz(const Quaternion& q);     // MuJoCo's order

// The matrix must be orthonormal with determinant +1 within 1e-6 (ArgumentError otherwise).
Quaternion QuaternionFromMatrix(const Eigen::Matrix3d& rotation);
Eigen::Matrix3d MatrixFromQuaternion(const Quaternion& q);

// The rotation b followed by a, like the product of matrices.
Quaternion QuaternionProduct(const Quaternion& a, const Quaternion& b);
Quaternion QuaternionInverse(const Quaternion& q);
Eigen::Vector3d Rotate(const Quaternion& q, const Eigen::Vector3d& v);

// Rotation vector (axis * angle) to quaternion and back. The angle that comes back is in [0, pi];
// both directions are accurate near 0 and near pi.
Quaternion QuaternionFromRotvec(const Eigen::Vector3d& rotvec);
Eigen::Vector3d RotvecFromQuaternion(const Quaternion& q);

// Roll, pitch, yaw: R = Rz(yaw) * Ry(pitch) * Rx(roll). What comes back has pitch in [-pi/2, pi/2],
// and roll 0 where pitch is +-pi/2 (gimbal lock, where only yaw -+ roll is defined).
Quaternion QuaternionFromRpy(const Eigen::Vector3d& rpy);
Eigen::Vector3d RpyFromQuaternion(const Quaternion& q);

// Angle of the rotation from a to b, in [0, pi].
double AngleBetween(const Quaternion& a, const Quaternion& b);
// Constant angular velocity along the shorter arc: a at s = 0, b at s = 1; other s continue the
// motion.
Quaternion Slerp(const Quaternion& a, const Quaternion& b, double s);

// All orientations are equally likely.
Quaternion RandomQuaternion(Rng& rng);

// The matrix S with S * b = a x b.
Eigen::Matrix3d Skew(const Eigen::Vector3d& a);

}  // namespace robocell
