#include "robocell/task/grasp_candidates.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <Eigen/Geometry>

#include "robocell/base/units.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/tree.h"
#include "robocell/task/remembered_grasps.h"
#include "robocell/task/suction_grasps.h"
#include "robocell/task/top_down.h"

namespace robocell {
namespace {

using internal::TopDown;

constexpr int kYaws = 12;                        // over half a turn
constexpr double kSideSteps[] = {0, -0.6, 0.6};  // shares of the half extent across
constexpr double kSupportClearance =
    0.003;                               // gap between fingertips and the object's support, metres
constexpr double kLeastOverlap = 0.012;  // overlap of pad and object along the approach
constexpr double kDeepGrip = 0.02;  // one of the heights tried: this far below a grip at the top
constexpr double kOpenClearance = 0.006;  // beside the object when the gripper is open, per finger
constexpr double kJawClearance = 0.004;   // beside a pad that does not move when the hand opens
constexpr double kLeastWidth = 0.006;
constexpr double kLeastAboveClosed = 0.005;  // wider than the closed gripper, to notice holding
constexpr double kLeastRange = 5e-4;         // range of held widths; a smaller one counts as none
constexpr double kTouchDepth = 0.0015;       // rays this near to the first touch end under the pad
constexpr double kMostPadUsed = 0.008;       // half width of the pad that rays are spread over
constexpr int kRaysAcross = 3, kRaysAlong = 3;
constexpr int kLeastHits = 3;

Interval ExtentAlong(const mjModel* m, const mjData* d, const std::vector<int>& geoms,
                     const Eigen::Vector3d& direction) {
  Interval all{1e9, -1e9};
  for (const int g : geoms) {
    const Interval e = internal::GeomExtent(m, d, g, direction);
    all = {std::min(all.lower, e.lower), std::max(all.upper, e.upper)};
  }
  return all;
}

double Length(const Interval& interval) { return interval.upper - interval.lower; }

// Returns the angle of a horizontal direction that is fixed in the body.
double BodyYaw(const mjData* d, int body) {
  const double* r = d->xmat + 9 * body;
  const int column = std::hypot(r[0], r[3]) > 0.5 ? 0 : 1;
  return std::atan2(r[3 + column], r[column]);
}

// The contacts that the pads would make.
struct Squeeze {
  double left, right;  // contact positions along the closing direction from the given point
  double square;       // cosine of the worse side's mean normal to the closing direction
  double cover;        // share of the worse side's rays that end where a pad touches
  double width() const { return left - right; }
};

// The ends of the rays over the pads' area.
struct PadRays {
  struct Hit {
    double at;      // along the closing direction
    double square;  // cosine of the normal to it
  };
  int hits = 0;
  std::array<Hit, kRaysAcross * kRaysAlong> left, right;
};

Squeeze Judge(const PadRays& rays) {
  Squeeze squeeze{.left = rays.left[0].at, .right = rays.right[0].at, .square = 0, .cover = 0};
  for (int i = 1; i < rays.hits; ++i) {
    squeeze.left = std::max(squeeze.left, rays.left[i].at);
    squeeze.right = std::min(squeeze.right, rays.right[i].at);
  }
  double left = 0, right = 0;
  int left_touching = 0, right_touching = 0;
  for (int i = 0; i < rays.hits; ++i) {
    if (rays.left[i].at > squeeze.left - kTouchDepth) left += rays.left[i].square, ++left_touching;
    if (rays.right[i].at < squeeze.right + kTouchDepth)
      right += rays.right[i].square, ++right_touching;
  }
  squeeze.square = std::min(left / left_touching, right / right_touching);
  squeeze.cover = std::min(left_touching, right_touching) / double{kRaysAcross * kRaysAlong};
  return squeeze;
}

class CandidateSearch {
 public:
  CandidateSearch(const mjModel* model, const mjData* data, int body, const GripperShape& shape)
      : m_(model),
        d_(data),
        body_(body),
        shape_(shape),
        geoms_(internal::CollisionGeomsOf(model, body)) {
    if (geoms_.empty()) return;
    height_ = ExtentAlong(m_, d_, geoms_, Eigen::Vector3d::UnitZ());
    away_ = 0.01 + Length(height_) + Length(ExtentAlong(m_, d_, geoms_, Eigen::Vector3d::UnitX())) +
            Length(ExtentAlong(m_, d_, geoms_, Eigen::Vector3d::UnitY()));
    com_ = Eigen::Vector3d(d_->subtree_com + 3 * body_);
    half_height_ = shape.pad_half_height();
    half_width_ = 0.8 * std::min(shape.pad_half_width(), kMostPadUsed / 0.8);
  }

  std::vector<GraspCandidate> Run() {
    const std::vector<double> heights = Heights();
    for (int i = 0; i < kYaws && !heights.empty(); ++i) {
      for (const double height : heights) TryHeight(Yaw(i), height);
    }
    return std::move(found_);
  }

  // Returns true if the pads get deep enough beside it.
  bool HasHeight() const { return !Heights().empty(); }

 private:
  // Returns the candidate heights of the pads' centre.
  std::vector<double> Heights() const {
    if (geoms_.empty()) return {};
    const double width = std::clamp(Thickness(), shape_.closed_gap(), shape_.open_gap());
    const double top = height_.upper;
    const double lowest =
        height_.lower + kSupportClearance + shape_.TipAt(width) - shape_.PadAt(width).z();
    const double highest = top + half_height_ - std::min(2 * half_height_, kLeastOverlap);
    if (lowest > highest) return {};
    std::vector<double> heights;
    for (const double wanted : {com_.z(), (height_.lower + top) / 2, top - half_height_,
                                top - half_height_ - kDeepGrip}) {
      heights.push_back(std::clamp(wanted, lowest, highest));
    }
    std::sort(heights.begin(), heights.end());
    const auto near = [](double a, double b) { return b - a < 1e-4; };
    heights.erase(std::unique(heights.begin(), heights.end(), near), heights.end());
    return heights;
  }

  // Returns the extent across the thinnest horizontal direction.
  double Thickness() const {
    double least = 1e9;
    for (int i = 0; i < kYaws; ++i) {
      least = std::min(least, Length(ExtentAlong(m_, d_, geoms_, TopDown(Yaw(i)).col(1))));
    }
    return least;
  }

  double Yaw(int i) const { return BodyYaw(d_, body_) + internal::kPi * i / kYaws; }

  void TryHeight(double yaw, double height) {
    const Eigen::Matrix3d axes = TopDown(yaw);
    const double reach = Length(ExtentAlong(m_, d_, geoms_, axes.col(0))) / 2;
    for (const double side : kSideSteps) {
      const Eigen::Vector3d at =
          Eigen::Vector3d(com_.x(), com_.y(), height) + side * reach * axes.col(0);
      const PadRays rays = Cast(at, axes);
      if (rays.hits >= kLeastHits) Add(at, yaw, Judge(rays));
    }
  }

  // Casts rays from both sides over the pads' area.
  PadRays Cast(const Eigen::Vector3d& at, const Eigen::Matrix3d& axes) const {
    const Eigen::Vector3d x = axes.col(0), y = axes.col(1);
    const double up = std::min(half_height_, height_.upper - at.z()) - 0.001;
    PadRays rays;
    for (int i = 0; i < kRaysAcross; ++i) {
      for (int k = 0; k < kRaysAlong; ++k) {
        const double rise = 0.95 * (-half_height_ + (up + half_height_) * k / (kRaysAlong - 1));
        const Eigen::Vector3d from = at + half_width_ * (i - 1) * x + Eigen::Vector3d(0, 0, rise);
        const internal::RayHit left = internal::CastRay(m_, d_, geoms_, from + away_ * y, -y);
        if (!std::isfinite(left.distance)) continue;
        const internal::RayHit right = internal::CastRay(m_, d_, geoms_, from - away_ * y, y);
        if (!std::isfinite(right.distance)) continue;
        rays.left[rays.hits] = {away_ - left.distance, left.normal.dot(y)};
        rays.right[rays.hits] = {right.distance - away_, -right.normal.dot(y)};
        ++rays.hits;
      }
    }
    return rays;
  }

  void Add(const Eigen::Vector3d& at, double yaw, const Squeeze& squeeze) {
    static const double kLeastSquare = std::cos(internal::Radians(25.0));
    const double width = squeeze.width();
    if (width < std::max(kLeastWidth, shape_.closed_gap() + kLeastAboveClosed)) return;
    if (width > shape_.open_gap() - 2 * kOpenClearance || squeeze.square < kLeastSquare) return;
    const Eigen::Vector3d middle = at + TopDown(yaw).col(1) * (squeeze.left + squeeze.right) / 2;
    const double cost = 6 * (middle - com_).head<2>().norm() +
                        2 * std::max(0.0, std::abs(at.z() - com_.z()) - 0.01) +
                        0.3 * (1 - squeeze.square) + 0.05 * (1 - squeeze.cover) +
                        3 * std::max(0.0, 0.012 - width) + 0.3 * width;
    const double aside = AsideFor(shape_, width);
    const Eigen::Vector3d held = shape_.PadAt(width) + aside * Eigen::Vector3d::UnitY();
    for (const double flip : {0.0, internal::kPi}) {  // either finger may be left
      const Eigen::Matrix3d axes = TopDown(yaw + flip);
      const Pose tcp = Pose(middle - axes * held, axes) * shape_.grasp_in_tcp().inverse();
      found_.push_back(
          {.tcp_in_world = tcp, .width = width, .aside = std::abs(aside), .cost = cost});
    }
  }

  const mjModel* m_;
  const mjData* d_;
  int body_;
  const GripperShape& shape_;
  std::vector<int> geoms_;
  double away_ = 0;    // further than the object is large
  Interval height_{};  // heights of the object's lowest and highest point
  Eigen::Vector3d com_ = Eigen::Vector3d::Zero();
  double half_height_ = 0, half_width_ = 0;
  std::vector<GraspCandidate> found_;
};

constexpr double kTurnCost = 0.02;  // per radian
constexpr int kOtherSamples = 600, kMostOthers = 60;

}  // namespace

std::vector<GraspCandidate> FindGrasps(const mjModel* m, const mjData* d, int object_body,
                                       const GripperShape& shape, const Pose& tcp_now) {
  std::vector<GraspCandidate> grasps = shape.is_suction()
                                           ? internal::FindSuctionGrasps(m, d, object_body, shape)
                                           : CandidateSearch(m, d, object_body, shape).Run();
  for (GraspCandidate& grasp : grasps) {
    grasp.cost += kTurnCost * AngleBetween(tcp_now.quaternion(), grasp.tcp_in_world.quaternion());
  }
  std::stable_sort(grasps.begin(), grasps.end(),
                   [](const auto& a, const auto& b) { return a.cost < b.cost; });
  return grasps;
}

std::vector<GraspCandidate> FindOtherGrasps(const Robot& robot, const std::string& object_body,
                                            const GripperShape& shape, const Pose& tcp_now) {
  if (shape.is_suction()) return {};
  const GraspSet set = internal::RememberedGrasps(robot, object_body,
                                                  {.samples = kOtherSamples, .most = kMostOthers});
  const Pose body_in_world = robot.scene().body_pose(set.body);
  std::vector<GraspCandidate> grasps;
  for (const Grasp& grasp : set.grasps) {
    const Pose tcp = body_in_world * grasp.tcp_in_body;
    grasps.push_back(
        {.tcp_in_world = tcp,
         .width = grasp.width,
         .aside = grasp.aside,
         .cost = 1 - grasp.score + kTurnCost * AngleBetween(tcp_now.quaternion(), tcp.quaternion()),
         .opening = grasp.opening,
         .approach = Rotate(body_in_world.quaternion(), grasp.approach)});
  }
  std::stable_sort(grasps.begin(), grasps.end(),
                   [](const auto& a, const auto& b) { return a.cost < b.cost; });
  return grasps;
}

double AsideFor(const GripperShape& shape, double width) {
  const double half = (shape.AcrossAt(shape.open_gap()) - shape.AcrossAt(width)) / 2;
  const double moved = shape.PadAt(shape.open_gap()).y() - shape.PadAt(width).y();
  return std::max(kJawClearance - (half - moved), 0.0) -
         std::max(kJawClearance - (half + moved), 0.0);
}

HeldWidths WidthsHeld(double closed_gap, double open_gap) {
  return {std::max(kLeastWidth, closed_gap + kLeastAboveClosed),
          std::max(open_gap - 2 * kOpenClearance, 0.0)};
}

std::string DescribeHeldWidths(double closed_gap, double open_gap) {
  const auto [least, most] = WidthsHeld(closed_gap, open_gap);
  if (most - least > kLeastRange) return fmt::format("holds from {:.3g} to {:.3g} m", least, most);
  return fmt::format(
      "holds nothing: open, its fingers are {:.3g} m apart, which leaves {:.3g} m between {:g} m "
      "of "
      "clearance on both sides, and {:.3g} m are the least that it can hold",
      open_gap, most, kOpenClearance, least);
}

std::string SizesForGrasp(const mjModel* model, const mjData* data, int object_body,
                          const GripperShape& shape) {
  const std::vector<int> geoms = internal::CollisionGeomsOf(model, object_body);
  if (geoms.empty()) return "none of its geoms collides";
  if (shape.is_suction()) return internal::WhyNothingSticks(shape);
  double narrowest = std::numeric_limits<double>::infinity();
  for (int k = 0; k < kYaws; ++k) {
    const double yaw = BodyYaw(data, object_body) + k * internal::kPi / kYaws;
    const Eigen::Vector3d across(std::cos(yaw), std::sin(yaw), 0);
    narrowest = std::min(narrowest, Length(ExtentAlong(model, data, geoms, across)));
  }
  const auto [least, most] = WidthsHeld(shape.closed_gap(), shape.open_gap());
  const std::string sizes =
      fmt::format("it is {:.3g} m wide where it is narrowest and {:.3g} m high, and the gripper {}",
                  narrowest, Length(ExtentAlong(model, data, geoms, Eigen::Vector3d::UnitZ())),
                  DescribeHeldWidths(shape.closed_gap(), shape.open_gap()));
  if (narrowest < least || narrowest > most) return sizes;
  if (!CandidateSearch(model, data, object_body, shape).HasHeight()) {
    return fmt::format(
        "{}, but on the way to that width its fingertips reach {:.3g} m below the middle of the "
        "pads, so that they touch what it stands on before the pads have {:g} m of it",
        sizes, shape.TipAt(narrowest) - shape.PadAt(narrowest).z(), kLeastOverlap);
  }
  return sizes + ", but where the pads would touch, its sides do not face each other squarely";
}

}  // namespace robocell
