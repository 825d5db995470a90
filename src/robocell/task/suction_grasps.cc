#include "robocell/task/suction_grasps.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <Eigen/Geometry>

#include "robocell/base/units.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/task/top_down.h"

namespace robocell::internal {
namespace {

constexpr int kYaws = 8;                        // over a whole turn: a cup has no closing direction
constexpr double kSteps[] = {0, -0.4, 0.4};     // places: shares of the half extents
constexpr double kRings[] = {0.5, 0.95};        // rays: shares of the cup's radius ...
constexpr int kRaysOnRing = 8;                  // ... and their number on each
constexpr double kFlat = 1e-3;                  // m, below the highest ray
constexpr double kPress = 1e-3;                 // m, into the object
constexpr double kCostOfOffset = 6;             // per metre beside the centre of mass
const double kLevel = std::cos(Radians(10.0));  // cosine of the normal to the vertical

// Finds the height of an object's top over the face of a cup.
class TopSurvey {
 public:
  TopSurvey(const mjModel* m, const mjData* d, int body, const GripperShape& shape)
      : m_(m), d_(d), shape_(shape), geoms_(CollisionGeomsOf(m, body)) {
    for (const int g : geoms_)
      above_ = std::max(above_, GeomExtent(m, d, g, Eigen::Vector3d::UnitZ()).upper + 0.01);
  }

  const std::vector<int>& geoms() const { return geoms_; }

  // Unset if the object is not flat and level there.
  std::optional<double> HeightAt(const Eigen::Vector2d& at) const {
    const std::optional<double> middle = Ray(at);
    if (!middle) return std::nullopt;
    double lowest = *middle, highest = *middle;
    for (const double ring : kRings) {
      for (int k = 0; k < kRaysOnRing; ++k) {
        const double angle = 2 * kPi * k / kRaysOnRing;
        const double radius = ring * std::max(shape_.pad_half_width(), shape_.pad_half_height());
        const std::optional<double> height =
            Ray(at + radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
        if (!height) return std::nullopt;
        lowest = std::min(lowest, *height);
        highest = std::max(highest, *height);
      }
    }
    return highest - lowest <= kFlat ? std::optional(highest) : std::nullopt;
  }

 private:
  // The height of a level surface; unset if the ray misses the object or the surface is tilted.
  std::optional<double> Ray(const Eigen::Vector2d& at) const {
    const Eigen::Vector3d from(at.x(), at.y(), above_);
    const RayHit hit = CastRay(m_, d_, geoms_, from, -Eigen::Vector3d::UnitZ());
    if (!std::isfinite(hit.distance) || hit.normal.z() < kLevel) return std::nullopt;
    return above_ - hit.distance;
  }

  const mjModel* m_;
  const mjData* d_;
  const GripperShape& shape_;
  std::vector<int> geoms_;
  double above_ = -1e9;  // a height above the object
};

}  // namespace

std::vector<GraspCandidate> FindSuctionGrasps(const mjModel* m, const mjData* d, int object_body,
                                              const GripperShape& shape) {
  const TopSurvey top(m, d, object_body, shape);
  std::vector<GraspCandidate> found;
  if (top.geoms().empty()) return found;
  const Eigen::Map<const Eigen::Vector3d> com(d->subtree_com + 3 * object_body);
  const auto half_along = [&](const Eigen::Vector3d& axis) {
    double lower = 1e9, upper = -1e9;
    for (const int g : top.geoms()) {
      const Interval extent = GeomExtent(m, d, g, axis);
      lower = std::min(lower, extent.lower);
      upper = std::max(upper, extent.upper);
    }
    return (upper - lower) / 2;
  };
  const double half_x = half_along(Eigen::Vector3d::UnitX());
  const double half_y = half_along(Eigen::Vector3d::UnitY());
  for (const double x : kSteps) {
    for (const double y : kSteps) {
      const Eigen::Vector2d offset(x * half_x, y * half_y), at = com.head<2>() + offset;
      const std::optional<double> height = top.HeightAt(at);
      if (!height) continue;
      const Eigen::Vector3d middle(at.x(), at.y(), *height - kPress);
      for (int k = 0; k < kYaws; ++k) {
        const Eigen::Matrix3d axes = TopDown(2 * kPi * k / kYaws);
        const Pose tcp =
            Pose(middle - axes * shape.PadAt(0), axes) * shape.grasp_in_tcp().inverse();
        found.push_back({.tcp_in_world = tcp, .cost = kCostOfOffset * offset.norm()});
      }
    }
  }
  return found;
}

std::string WhyNothingSticks(const GripperShape& shape) {
  return fmt::format("its top is not flat and level over the {:.3g} m of the suction cup",
                     2 * std::max(shape.pad_half_width(), shape.pad_half_height()));
}

}  // namespace robocell::internal
