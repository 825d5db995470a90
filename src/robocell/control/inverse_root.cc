#include "robocell/control/inverse_root.h"

#include <array>
#include <cmath>

namespace robocell::internal {
namespace {

// The arithmetic-geometric mean: the sequence from 1 and the root of 1 / range to their common
// limit.
struct Means {
  static constexpr int kSteps = 12;
  std::array<double, kSteps + 1> mean, half_gap;

  explicit Means(double least_root) {
    double a = 1, b = least_root;
    mean[0] = a;
    half_gap[0] = 0;  // not used
    for (int k = 1; k <= kSteps; ++k) {
      half_gap[k] = (a - b) / 2;
      const double geometric = std::sqrt(a * b);
      a = mean[k] = (a + b) / 2;
      b = geometric;
    }
  }
  double quarter_period() const { return M_PI / (2 * mean[kSteps]); }
  // Computes Jacobi's amplitude by Landen's transformation (M. Abramowitz, I. A. Stegun, "Handbook
  // of Mathematical Functions", 16.4).
  double Amplitude(double u) const {
    double angle = std::ldexp(mean[kSteps] * u, kSteps);
    for (int k = kSteps; k > 0; --k)
      angle = (angle + std::asin(half_gap[k] / mean[k] * std::sin(angle))) / 2;
    return angle;
  }
};

// Poles of a midpoint rule for A^(-1/2) = 2/pi * integral over t of (A + t^2)^-1, evenly spread
// after t = least_root * sn / cn.
InverseRoot MakeInverseRoot(double range, int n_poles) {
  InverseRoot root;
  root.n_poles = n_poles;
  root.range = range;
  const double least_root = 1 / std::sqrt(range);
  const Means means(least_root);
  const double step = means.quarter_period() / n_poles;
  for (int k = 0; k < (n_poles + 1) / 2; ++k) {
    const double angle = means.Amplitude((k + 0.5) * step);
    const double s = std::sin(angle), c = std::cos(angle);
    const double t = least_root * s / c;
    const double slope = least_root * std::sqrt(c * c + s * s / range) / (c * c);
    root.shift[k] = t * t;
    root.weight[k] = 2 / M_PI * step * slope;
    // The other half mirrors it.
    root.shift[n_poles - 1 - k] = 1 / (range * t * t);
    root.weight[n_poles - 1 - k] = root.weight[k] * least_root / (t * t);
  }
  return root;
}

}  // namespace

const InverseRoot* InverseRoots() {
  static const std::array<InverseRoot, kInverseRoots> roots = {
      MakeInverseRoot(2.8e4, 7), MakeInverseRoot(1e11, 16), MakeInverseRoot(1e16, 24)};
  return roots.data();
}

}  // namespace robocell::internal
