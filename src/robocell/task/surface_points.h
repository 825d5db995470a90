// Points on the surface of solids, uniform over the area: random straight lines hit a surface in
// proportion to its area (Crofton), so that every kind of solid is sampled in one way.
#pragma once

#include <cmath>

#include <optional>
#include <vector>
#include <Eigen/Core>
#include <Eigen/Geometry>

#include "robocell/base/rng.h"
#include "robocell/task/convex_solid.h"

namespace robocell::internal {

// Returns a direction uniform over the sphere.
inline Eigen::Vector3d UniformDirection(Rng& rng) {
  const double z = rng.Uniform(-1, 1), turn = rng.Uniform(-M_PI, M_PI), r = std::sqrt(1 - z * z);
  return {r * std::cos(turn), r * std::sin(turn), z};
}

struct SurfacePoint {
  Eigen::Vector3d at, normal;  // outward
  int geom = -1;
};

class SurfaceSampler {
 public:
  // Samples the surface of `part` where it is not inside `all`. Both must outlive this object.
  SurfaceSampler(const BodySolids& part, const BodySolids& all, Rng& rng)
      : part_(part), all_(all), rng_(rng) {}

  // Unset if the solids are so thin, or so deep inside others, that no line hits them.
  std::optional<SurfacePoint> Next() {
    if (part_.empty()) return std::nullopt;
    for (int tries = 0; tries < kMostLines; ++tries) {
      const Eigen::Vector3d d = UniformDirection(rng_), x = d.unitOrthogonal(), y = d.cross(x);
      const double radius = part_.radius() * std::sqrt(rng_.Uniform()),
                   turn = rng_.Uniform(-M_PI, M_PI);
      const Eigen::Vector3d from =
          part_.centre() + radius * (std::cos(turn) * x + std::sin(turn) * y);
      part_.Through(from, d, &spans_);
      if (spans_.empty()) continue;
      const SolidSpan& span = spans_[rng_.UniformInt(spans_.size())];
      const bool first = rng_.Uniform() < 0.5;
      const SurfacePoint point = {.at = from + (first ? span.begin : span.end) * d,
                                  .normal = first ? span.begin_normal : span.end_normal,
                                  .geom = first ? span.begin_geom : span.end_geom};
      if (&part_ != &all_ && all_.Contains(point.at + kOutside * point.normal)) continue;
      return point;
    }
    return std::nullopt;
  }

 private:
  static constexpr int kMostLines = 2000;
  static constexpr double kOutside = 1e-6;  // m

  const BodySolids& part_;
  const BodySolids& all_;
  Rng& rng_;
  std::vector<SolidSpan> spans_;
};

}  // namespace robocell::internal
