#include "robocell/kinematics/ik_targets.h"

#include <fmt/format.h>

#include "robocell/base/error.h"

namespace robocell {
namespace {

using RowMajor = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;

// Products of a few rotations deviate from a rotation by no more than this.
constexpr double kRounding = 1e-14;

// Returns true if a matrix is a rigid transform to rounding, false if it is not finite.
bool IsRigid(const double* m) {
  const double* x = m;  // rows
  const double* y = m + 4;
  const double* z = m + 8;
  const auto dot = [](const double* a, const double* b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  };
  const double off[6] = {dot(x, x) - 1, dot(y, y) - 1, dot(z, z) - 1,
                         dot(x, y),     dot(x, z),     dot(y, z)};
  double off2 = 0;
  for (const double one : off) off2 += one * one;
  const double determinant = x[0] * (y[1] * z[2] - y[2] * z[1]) +
                             x[1] * (y[2] * z[0] - y[0] * z[2]) +
                             x[2] * (y[0] * z[1] - y[1] * z[0]);
  const bool homogeneous = m[12] == 0 && m[13] == 0 && m[14] == 0 && m[15] == 1;
  const double finite = 0 * (x[3] + y[3] + z[3]);
  return off2 + finite <= kRounding * kRounding && determinant > 0 && homogeneous;
}

}  // namespace

IkTargets IkTargets::FromMatrices(std::span<const double> matrices, std::string_view name) {
  if (matrices.size() % 16 != 0) {
    throw ArgumentError(
        fmt::format("{}: expected 16 values for each 4x4 matrix, got {}", name, matrices.size()));
  }
  IkTargets targets;
  targets.matrices_ = matrices;
  for (std::size_t b = 0; b < targets.size(); ++b) {
    const double* matrix = matrices.data() + 16 * b;
    if (IsRigid(matrix)) continue;
    targets.all_rigid_ = false;
    try {
      Normalised(matrix);
    } catch (const ArgumentError& error) {
      throw ArgumentError(fmt::format("{}[{}]: {}", name, b, error.what()));
    }
  }
  return targets;
}

Transform IkTargets::Normalised(const double* matrix) {
  if (IsRigid(matrix)) return AsItIs(matrix);
  return ToTransform(Pose::FromMatrix(Eigen::Map<const RowMajor>(matrix)));
}

}  // namespace robocell
