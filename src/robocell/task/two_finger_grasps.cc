// Antipodal grasps: pairs of surface points that two pads can press on within the friction cones.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>
#include <Eigen/Geometry>

#include "robocell/task/grasp_candidates.h"
#include "robocell/task/grasp_proposals.h"
#include "robocell/task/grasp_request.h"
#include "robocell/task/surface_points.h"

namespace robocell::internal {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kDirections = 8;  // of the approach around the closing direction
constexpr int kHandPoints = 160;
constexpr int kOpenings = 8;            // gaps of the fingers that are tried
constexpr double kBeside = 0.006;       // m: beside the object when the hand is open, per finger
constexpr double kLeastGrip = 5e-4;     // m: wider than the closed hand
constexpr double kInsideTarget = 5e-4;  // m: points of the hand that are deeper collide
constexpr int kAcross = 3;  // lines over the pads, and where they are along the approach:
constexpr std::array kAlong = {-0.95, -0.6, 0.0, 0.6, 0.95};  // shares of the half height
constexpr int kLeastPadHits = 3;
constexpr double kUnderPad = 0.0015;      // m: lines this near to the first touch end under the pad
constexpr double kPadSpread = 0.008;      // m: half width of the pad that lines are spread over
constexpr double kSameWidth = 0.004;      // m: curved faces touch the pads' edges first
constexpr double kBeforeContact = 0.003;  // m between the pads and the object just before contact
constexpr double kShallow = 0.6;          // share of the pad's half height of a shallower grasp
constexpr double kWall = 0.35;            // a wall is thinner than this share of the vessel
constexpr double kEnoughRoom = 0.01;      // m: beyond the widest and the thinnest object
constexpr double kNearCom = 0.01;         // m

// The hand at one gap.
struct Opening {
  double gap = 0;
  Eigen::Matrix3Xd points;  // of its surface, in the TCP's frame
};

struct PadSqueeze {
  double left = 0, right = 0;  // along the closing direction from the middle
  double square = 0, cover = 0;
};

class TwoFingerSearch {
 public:
  TwoFingerSearch(const GraspTarget& target, const HandGeometry& hand, const GraspOptions& options,
                  Rng rng)
      : target_(target),
        shape_(hand.shape()),
        options_(options),
        rng_(rng),
        least_square_(std::cos(std::atan(options.friction))),
        widths_(WidthsHeld(shape_.closed_gap(), shape_.open_gap())),
        half_height_(shape_.pad_half_height()),
        half_width_(std::min(0.8 * shape_.pad_half_width(), kPadSpread)) {
    widths_.least = std::max(shape_.closed_gap() + kLeastGrip, kLeastGrip);
    for (int i = 1; i <= kOpenings; ++i) {
      const double gap =
          shape_.closed_gap() + (shape_.open_gap() - shape_.closed_gap()) * i / kOpenings;
      openings_.push_back({gap, hand.SurfacePoints(gap, kHandPoints)});
    }
  }

  std::vector<GraspProposal> Run() {
    if (widths_.most <= widths_.least) return {};
    SurfaceSampler sampler(target_.wanted, target_.all, rng_);
    for (int i = 0; i < options_.samples; ++i) {
      const std::optional<SurfacePoint> point = sampler.Next();
      if (!point) break;
      // Most closing directions are normals; the others lean within the friction cone.
      Vector3d closing = -point->normal;
      if (i % 3 == 2) closing = (closing + 0.5 * options_.friction * RandomInBall()).normalized();
      FromPoint(*point, closing,
                i % 2 == 0 ? 0 : rng_.Uniform(0, 2 * std::numbers::pi / kDirections));
    }
    return std::move(found_);
  }

 private:
  Vector3d RandomInBall() { return UniformDirection(rng_) * std::cbrt(rng_.Uniform()); }

  // Tries the pairs of the point with surfaces farther along the closing direction.
  void FromPoint(const SurfacePoint& point, const Vector3d& closing, double turn) {
    constexpr double kSame = 1e-5;  // m
    target_.all.Through(point.at, closing, &spans_);
    const auto first = std::ranges::find_if(
        spans_, [&](const SolidSpan& span) { return std::abs(span.begin) < kSame; });
    if (first == spans_.end() || -first->begin_normal.dot(closing) < least_square_) return;
    pair_spans_.assign(spans_.begin(), spans_.end());  // SqueezeAt overwrites the other ones
    const std::vector<SolidSpan>& spans = pair_spans_;
    const auto begin = static_cast<size_t>(first - spans_.begin());
    const double whole = spans.back().end - spans.front().begin;
    for (size_t k = begin; k < spans.size(); ++k) {
      const double width = spans[k].end - spans[begin].begin;
      if (width > widths_.most) break;
      if (width < widths_.least || spans[k].end_normal.dot(closing) < least_square_) continue;
      if (!target_.is_wanted[static_cast<size_t>(spans[k].end_geom)]) continue;
      const bool wall = spans.size() > 1 && k == begin && width < kWall * whole;
      const bool handle = target_.is_handle[static_cast<size_t>(point.geom)] &&
                          target_.is_handle[static_cast<size_t>(spans[k].end_geom)];
      const Vector3d middle = point.at + closing * (spans[k].end + spans[begin].begin) / 2;
      Around(middle, closing, width, turn, wall, handle);
    }
  }

  // Tries approaches around the closing direction.
  void Around(const Vector3d& middle, const Vector3d& closing, double width, double turn, bool wall,
              bool handle) {
    Vector3d reference = -Vector3d::UnitZ();
    if (reference.cross(closing).norm() < 0.3) reference = Vector3d::UnitX();
    reference = (reference - reference.dot(closing) * closing).normalized();
    for (int k = 0; k < kDirections; ++k) {
      const double angle = turn + 2 * std::numbers::pi * k / kDirections;
      const Vector3d approach = Eigen::AngleAxisd(angle, closing) * reference;
      // Either finger may be on either side.
      const Vector3d y = rng_.Uniform() < 0.5 ? closing : Vector3d(-closing);
      TryOpenings(middle, GraspAxes(y, approach), width, wall, handle);
    }
  }

  // Tries the fully open hand, then the one that is just wide enough: it fits into vessels.
  void TryOpenings(const Vector3d& middle, const Matrix3d& axes, double width, bool wall,
                   bool handle) {
    const auto narrow = std::ranges::find_if(
        openings_, [&](const Opening& opening) { return opening.gap >= width + 2 * kBeside; });
    if (narrow == openings_.end()) return;
    for (const Opening* opening : {&openings_.back(), &*narrow}) {
      for (const double back : {0.0, kShallow * half_height_}) {
        if (Add(middle, axes, *opening, width, back, wall, handle)) return;
      }
      if (opening == &*narrow) return;
    }
  }

  bool Add(const Vector3d& middle, const Matrix3d& axes, const Opening& opening, double width,
           double back, bool wall, bool handle) {
    const Vector3d pads = middle - back * axes.col(2);
    const double aside = AsideFor(shape_, width);
    const Vector3d held = shape_.PadAt(width) + aside * Vector3d::UnitY();
    const Pose tcp = Pose(pads - axes * held, axes) * shape_.grasp_in_tcp().inverse();
    if (HitsObject(tcp, opening.points)) return false;
    const std::optional<PadSqueeze> squeeze = SqueezeAt(pads, axes, opening.gap);
    if (!squeeze || squeeze->square < least_square_) return false;
    const double real_width = squeeze->left - squeeze->right;
    if (std::abs(real_width - width) > kSameWidth || real_width > widths_.most) return false;
    const double off = std::abs(squeeze->left + squeeze->right) / 2;
    if (off > kSameWidth) return false;
    Grasp grasp{.tcp_in_body = tcp,
                .kind = KindOf(axes.col(2), wall, handle),
                .opening = opening.gap,
                .width = real_width,
                .aside = std::abs(aside),
                .approach = axes.col(2),
                .approach_length = options_.approach_length,
                .score = Score(*squeeze, real_width, middle, handle)};
    const double before = real_width + std::abs(aside) + shape_.closed_gap() + kBeforeContact;
    found_.push_back({.grasp = grasp, .gap_before = std::min(before, opening.gap)});
    return true;
  }

  static GraspKind KindOf(const Vector3d& approach, bool wall, bool handle) {
    if (handle) return GraspKind::kHandle;
    if (wall) return GraspKind::kRim;
    return KindOfApproach(approach);
  }

  double Score(const PadSqueeze& squeeze, double width, const Vector3d& middle, bool handle) const {
    const double square = (squeeze.square - least_square_) / (1 - least_square_);
    const double far = (middle - target_.com).norm() / (0.3 * target_.all.radius() + kNearCom);
    const double near = handle ? 1 : std::exp(-far);
    // Servos press less the nearer the fingers are to closed.
    const double room = std::clamp(
        std::min(widths_.most - width, width - shape_.closed_gap()) / kEnoughRoom, 0.0, 1.0);
    return 0.4 * square + 0.25 * squeeze.cover + 0.25 * near + 0.1 * room;
  }

  bool HitsObject(const Pose& tcp, const Eigen::Matrix3Xd& points) const {
    const Matrix3d axes = tcp.rotation();
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      const Vector3d point = axes * points.col(i) + tcp.translation();
      if (target_.all.Contains(point, kInsideTarget)) return true;
    }
    return false;
  }

  // Finds where the pads touch first; unset if they find too little between them.
  std::optional<PadSqueeze> SqueezeAt(const Vector3d& middle, const Matrix3d& axes, double gap) {
    std::array<double, kAcross * kAlong.size()> left, right, left_square, right_square;
    const double half = gap / 2;
    size_t hits = 0;
    for (int i = 0; i < kAcross; ++i) {
      for (const double along : kAlong) {
        const Vector3d from =
            middle + half_width_ * (i - 1) * axes.col(0) + along * half_height_ * axes.col(2);
        target_.all.Through(from, axes.col(1), &spans_);
        bool hit = false;
        for (const SolidSpan& span : spans_) {
          if (span.end < -half || span.begin > half) continue;
          if (!hit)
            right[hits] = span.begin, right_square[hits] = -span.begin_normal.dot(axes.col(1));
          left[hits] = span.end;
          left_square[hits] = span.end_normal.dot(axes.col(1));
          hit = true;
        }
        hits += hit;
      }
    }
    if (hits < kLeastPadHits) return std::nullopt;
    PadSqueeze squeeze{.left = *std::max_element(left.begin(), left.begin() + hits),
                       .right = *std::min_element(right.begin(), right.begin() + hits)};
    double on_left = 0, on_right = 0;
    int left_count = 0, right_count = 0;
    for (size_t i = 0; i < hits; ++i) {
      if (left[i] > squeeze.left - kUnderPad) on_left += left_square[i], ++left_count;
      if (right[i] < squeeze.right + kUnderPad) on_right += right_square[i], ++right_count;
    }
    squeeze.square = std::min(on_left / left_count, on_right / right_count);
    squeeze.cover =
        std::min(left_count, right_count) / static_cast<double>(kAcross * kAlong.size());
    return squeeze;
  }

  const GraspTarget& target_;
  const GripperShape& shape_;
  const GraspOptions& options_;
  Rng rng_;
  double least_square_;
  HeldWidths widths_;
  std::vector<Opening> openings_;  // by increasing gap
  double half_height_, half_width_;
  std::vector<SolidSpan> spans_, pair_spans_;
  std::vector<GraspProposal> found_;
};

}  // namespace

std::vector<GraspProposal> ProposeTwoFingerGrasps(const GraspTarget& target,
                                                  const HandGeometry& hand,
                                                  const GraspOptions& options, Rng rng) {
  return TwoFingerSearch(target, hand, options, rng).Run();
}

}  // namespace robocell::internal
