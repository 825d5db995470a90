// Contacts that hold or move an object from one side: a cup on a face, the tip of the closed hand
// on a face, the closed hand behind a bar.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <Eigen/Geometry>

#include "robocell/task/grasp_proposals.h"
#include "robocell/task/surface_points.h"

namespace robocell::internal {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kCupTurns = 8;  // of a cup about its axis: it has no closing direction
constexpr std::array kCupRings = {0.5, 0.95};  // shares of the radius
constexpr int kCupLinesOnRing = 8;
constexpr double kCupFlat = 1e-3;   // m: what a cup bridges, below the highest line
constexpr double kCupPress = 1e-3;  // m: a cup presses into the object
const double kCupLevel = std::cos(std::numbers::pi / 18);  // cosine of normals to the cup's axis
constexpr double kPushRadius = 0.006, kPushFlat = 2e-3;    // m: of the face that a tip pushes
constexpr double kJustApart = 5e-4;  // m between a pushing hand and the object
constexpr double kHookDepth = 0.01;  // m: the tip reaches beyond the bar's middle
constexpr double kMostBar = 0.06;    // m: thickness of a bar that is hooked
constexpr double kTipPart = 0.02;    // m: the part of the hand behind the bar
constexpr int kTipPoints = 400;

// Returns the height of the highest point of a face over a disc, above `point`; unset if the face is
// not flat within `flat`, or ends.
std::optional<double> FaceHeight(const BodySolids& solids, const SurfacePoint& point, double radius,
                                 double flat, std::vector<SolidSpan>* spans) {
  const Vector3d x = point.normal.unitOrthogonal(), y = point.normal.cross(x);
  const double away = 2 * solids.radius() + 0.01;
  double lowest = 0, highest = 0;
  for (const double ring : kCupRings) {
    for (int k = 0; k < kCupLinesOnRing; ++k) {
      const double angle = 2 * std::numbers::pi * k / kCupLinesOnRing;
      const Vector3d at = point.at + ring * radius * (std::cos(angle) * x + std::sin(angle) * y);
      solids.Through(at + away * point.normal, -point.normal, spans);
      if (spans->empty() || spans->front().begin_normal.dot(point.normal) < kCupLevel)
        return std::nullopt;
      const double height = away - spans->front().begin;
      lowest = std::min(lowest, height);
      highest = std::max(highest, height);
    }
  }
  if (highest - lowest > flat) return std::nullopt;
  return highest;
}

double NearCom(const GraspTarget& target, const Vector3d& point, const Vector3d& normal) {
  const Vector3d to = point - target.com;
  const double off = (to - to.dot(normal) * normal).norm();
  return std::exp(-off / (0.3 * target.all.radius() + 0.01));
}

}  // namespace

std::vector<GraspProposal> ProposeSuctionGrasps(const GraspTarget& target, const HandGeometry& hand,
                                                const GraspOptions& options, Rng rng) {
  const GripperShape& shape = hand.shape();
  const double radius = std::max(shape.pad_half_width(), shape.pad_half_height());
  std::vector<GraspProposal> found;
  std::vector<SolidSpan> spans;
  SurfaceSampler sampler(target.wanted, target.all, rng);
  for (int i = 0; i < options.samples; ++i) {
    const std::optional<SurfacePoint> point = sampler.Next();
    if (!point) break;
    const std::optional<double> height = FaceHeight(target.all, *point, radius, kCupFlat, &spans);
    if (!height) continue;
    const Vector3d z = -point->normal, middle = point->at + (*height - kCupPress) * point->normal;
    const double turn =
        2 * std::numbers::pi * static_cast<double>(rng.UniformInt(kCupTurns)) / kCupTurns;
    Vector3d reference = Vector3d::UnitX();
    if (reference.cross(z).norm() < 0.3) reference = Vector3d::UnitY();
    reference = (reference - reference.dot(z) * z).normalized();
    const Matrix3d axes = GraspAxes(Eigen::AngleAxisd(turn, z) * reference, z);
    found.push_back({.grasp = {.tcp_in_body = Pose(middle - axes * shape.PadAt(0), axes) *
                                              shape.grasp_in_tcp().inverse(),
                               .kind = GraspKind::kSuction,
                               .approach = z,
                               .approach_length = options.approach_length,
                               .score = NearCom(target, point->at, point->normal)},
                     .press = 2 * kCupPress});
  }
  return found;
}

std::vector<GraspProposal> ProposePushes(const GraspTarget& target, const HandGeometry& hand,
                                         const GraspOptions& options, Rng rng) {
  const GripperShape& shape = hand.shape();
  const double closed = shape.closed_gap();
  // The tip of the closed hand may be beside the pads' centre.
  const Eigen::Matrix3Xd points = hand.SurfacePoints(closed, kTipPoints);
  const Pose tcp_in_grasp = shape.grasp_in_tcp().inverse();
  Vector3d tip = Vector3d::Constant(-std::numeric_limits<double>::infinity());
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Vector3d at = tcp_in_grasp * Vector3d(points.col(i));
    if (at.z() > tip.z()) tip = at;
  }
  if (!tip.allFinite()) return {};
  tip.head<2>() = shape.PadAt(closed).head<2>();
  tip.z() = std::max(tip.z(), shape.rows().front().tip);
  std::vector<GraspProposal> found;
  std::vector<SolidSpan> spans;
  SurfaceSampler sampler(target.wanted, target.all, rng);
  for (int i = 0; i < options.samples; ++i) {
    const std::optional<SurfacePoint> point = sampler.Next();
    if (!point) break;
    const std::optional<double> height =
        FaceHeight(target.all, *point, kPushRadius, kPushFlat, &spans);
    if (!height) continue;
    const Vector3d z = -point->normal;
    const double turn = rng.Uniform(0, 2 * std::numbers::pi);
    const Matrix3d axes = GraspAxes(Eigen::AngleAxisd(turn, z) * z.unitOrthogonal(), z);
    const Vector3d at = point->at + (*height + kJustApart) * point->normal;
    found.push_back({.grasp = {.tcp_in_body = Pose(at - axes * tip, axes) * tcp_in_grasp,
                               .kind = GraspKind::kPush,
                               .opening = closed,
                               .approach = z,
                               .approach_length = options.approach_length,
                               .score = NearCom(target, point->at, point->normal)},
                     .gap_before = closed});
  }
  return found;
}

std::vector<GraspProposal> ProposeHooks(const GraspTarget& target, const HandGeometry& hand,
                                        const GraspOptions& options, Rng rng) {
  const GripperShape& shape = hand.shape();
  const double closed = shape.closed_gap();
  const Pose tcp_in_grasp = shape.grasp_in_tcp().inverse();
  const Eigen::Matrix3Xd points = hand.SurfacePoints(closed, kTipPoints);
  double tip = -std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    tip = std::max(tip, (tcp_in_grasp * Vector3d(points.col(i))).z());
  Eigen::AlignedBox3d hook;  // the part of the hand that goes behind the bar, grasp frame
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Vector3d at = tcp_in_grasp * Vector3d(points.col(i));
    if (at.z() > tip - kTipPart) hook.extend(at);
  }
  if (hook.isEmpty()) return {};
  std::vector<GraspProposal> found;
  std::vector<SolidSpan> spans;
  SurfaceSampler sampler(target.wanted, target.all, rng);
  for (int i = 0; i < options.samples; ++i) {
    const std::optional<SurfacePoint> point = sampler.Next();
    if (!point) break;
    target.all.Through(point->at, -point->normal, &spans);
    const auto bar = std::ranges::find_if(
        spans, [](const SolidSpan& span) { return std::abs(span.begin) < 1e-5; });
    if (bar == spans.end() || bar->end > kMostBar) continue;
    const double angle = rng.Uniform(0, 2 * std::numbers::pi);
    const Vector3d z = Eigen::AngleAxisd(angle, point->normal) * point->normal.unitOrthogonal();
    // A side of the hand, +-x or +-y of the grasp frame, presses against the surface.
    const auto side = static_cast<int>(rng.UniformInt(4));
    const Vector3d out = -point->normal * (side % 2 == 0 ? 1 : -1);
    const Matrix3d axes = GraspAxes(side < 2 ? z.cross(out) : out, z);
    Vector3d touch = hook.center();
    touch[side < 2 ? 0 : 1] = (side % 2 == 0 ? hook.max() : hook.min())[side < 2 ? 0 : 1];
    touch.z() = tip - kHookDepth;
    const Vector3d at = point->at + kJustApart * point->normal;
    found.push_back({.grasp = {.tcp_in_body = Pose(at - axes * touch, axes) * tcp_in_grasp,
                               .kind = GraspKind::kHook,
                               .opening = closed,
                               .approach = z,
                               .approach_length = options.approach_length,
                               .score = std::exp(-bar->end / kMostBar)},
                     .gap_before = closed});
  }
  return found;
}

}  // namespace robocell::internal
