// IkTargets: poses of the tip in the base frame (metres) for a batch of queries, as Poses or as the
// numbers of matrices.
//
//   IkBatch(chain, poses);                             // std::vector<Pose>
//   IkBatch(chain, IkTargets::FromMatrices(numbers));  // B x 4 x 4 numbers, as numpy has them
#pragma once

#include <concepts>
#include <span>
#include <string_view>
#include <vector>

#include "robocell/kinematics/transform.h"

namespace robocell {

// Refers to its sources, and allocates nothing.
class IkTargets {
 public:
  IkTargets() = default;
  template <class Poses>
  requires std::convertible_to<const Poses&, std::span<const Pose>> IkTargets(const Poses& poses)
      : poses_(poses) {}
  IkTargets(const Pose* poses, std::size_t count) : poses_(poses, count) {}
  // Uses B homogeneous 4x4 matrices, row by row, translations in metres. Rotations are used
  // unchanged if they are orthonormal to rounding (products of their rows are within 1e-14 of 0 and
  // 1), else normalised like in Pose. Throws ArgumentError with the row, "targets[17]: ...", for a
  // matrix that is not a rigid transform.
  static IkTargets FromMatrices(std::span<const double> matrices,
                                std::string_view name = "targets");

  std::size_t size() const { return matrices_.empty() ? poses_.size() : matrices_.size() / 16; }
  bool empty() const { return size() == 0; }
  Transform operator[](std::size_t b) const {
    return matrices_.empty() ? ToTransform(poses_[b]) : FromMatrix(matrices_.data() + 16 * b);
  }
  bool is_finite(std::size_t b) const { return !matrices_.empty() || IsFinite(poses_[b]); }

 private:
  Transform FromMatrix(const double* m) const { return all_rigid_ ? AsItIs(m) : Normalised(m); }
  static Transform AsItIs(const double* m) {
    Transform t;
    t.rotation << m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10];
    t.translation << m[3], m[7], m[11];
    return t;
  }
  // Returns a rigid transform unchanged, so that nothing depends on the others.
  static Transform Normalised(const double* matrix);

  std::span<const Pose> poses_;
  std::span<const double> matrices_;
  bool all_rigid_ = true;  // true if all rotations are orthonormal to rounding
};

}  // namespace robocell
