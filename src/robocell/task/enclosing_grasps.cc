// Grasps of hands with three fingers or more: the hand comes towards a face, and its fingers close
// around the object, each until it touches.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>
#include <Eigen/Geometry>

#include "robocell/task/grasp_proposals.h"
#include "robocell/task/surface_points.h"

namespace robocell::internal {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kOpenHandPoints = 160;
constexpr double kInsideObject = 5e-4;  // m: points of the hand that are deeper collide
constexpr double kDeepest = 0.05;       // m: of the pads' centre below the face
constexpr double kNearMiddle = 0.01;    // m

}  // namespace

std::vector<GraspProposal> ProposeEnclosingGrasps(const GraspTarget& target,
                                                  const HandGeometry& hand,
                                                  const GraspOptions& options, Rng rng) {
  const GripperShape& shape = hand.shape();
  const double open = shape.open_gap();
  const Vector3d pads = shape.PadAt((open + shape.closed_gap()) / 2);
  const Eigen::Matrix3Xd points = hand.SurfacePoints(open, kOpenHandPoints);
  std::vector<GraspProposal> found;
  std::vector<SolidSpan> spans;
  SurfaceSampler sampler(target.wanted, target.all, rng);
  for (int i = 0; i < options.samples; ++i) {
    const std::optional<SurfacePoint> point = sampler.Next();
    if (!point) break;
    const Vector3d z = -point->normal;
    target.all.Through(point->at, z, &spans);
    const auto span = std::ranges::find_if(
        spans, [](const SolidSpan& each) { return std::abs(each.begin) < 1e-5; });
    if (span == spans.end()) continue;
    const double depth = std::min(span->end / 2, kDeepest) * rng.Uniform(0.3, 1);
    const Vector3d middle = point->at + depth * z;
    const double turn = rng.Uniform(0, 2 * std::numbers::pi);
    const Matrix3d axes = GraspAxes(Eigen::AngleAxisd(turn, z) * z.unitOrthogonal(), z);
    const Pose tcp = Pose(middle - axes * pads, axes) * shape.grasp_in_tcp().inverse();
    const Matrix3d turned = tcp.rotation();
    bool hits = false;
    for (Eigen::Index k = 0; k < points.cols() && !hits; ++k)
      hits = target.all.Contains(turned * points.col(k) + tcp.translation(), kInsideObject);
    if (hits) continue;
    const double far = (middle - target.com).norm() / (0.3 * target.all.radius() + kNearMiddle);
    found.push_back({.grasp = {.tcp_in_body = tcp,
                               .kind = GraspKind::kEnclosing,
                               .opening = open,
                               .approach = z,
                               .approach_length = options.approach_length,
                               .score = std::exp(-far)},
                     .gap_before = open});
  }
  return found;
}

}  // namespace robocell::internal
