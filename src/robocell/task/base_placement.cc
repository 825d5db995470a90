#include "robocell/task/base_placement.h"

#include <algorithm>
#include <cmath>

#include "robocell/kinematics/low_discrepancy.h"

namespace robocell {
namespace {

constexpr double kWidening = 0.15;  // share of the range that each further attempt spreads by

// Folds a number into [0, 1] at the ends.
double Reflected(double u) {
  u = std::abs(u);
  return u > 1 ? std::max(0.0, 2 - u) : u;
}

}  // namespace

BasePlacement SpreadBasePlacement(const BaseRange& range, uint64_t seed, uint64_t turn, int attempt,
                                  Rng& rng) {
  const auto point = [&](uint64_t base, const char* purpose) {
    const double shifted = RadicalInverse(turn + 1, base) + Rng::Stream(seed, purpose).Uniform();
    const double even = shifted - std::floor(shifted);
    const double spread = std::min(1.0, kWidening * attempt);
    return Reflected(even + spread * rng.Uniform(-1, 1));
  };
  const double u = point(2, "base distance");
  const double v = point(3, "base height");
  return {std::lerp(range.distance[0], range.distance[1], u),
          range.height_offset + std::lerp(range.height_noise[0], range.height_noise[1], v)};
}

}  // namespace robocell
