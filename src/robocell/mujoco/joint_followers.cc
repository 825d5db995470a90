#include "robocell/mujoco/joint_followers.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace robocell::internal {
namespace {

// Evaluates an affine polynomial at a number that may be infinite.
double AffineAt(const JointPolynomial& p, double x) {
  return p.c[1] == 0 ? p.c[0] : p.c[0] + p.c[1] * (x - p.from);
}

// Returns where a monotone polynomial has a value that it has within the range.
double PlaceOf(const JointPolynomial& p, double value, const JointRange& x) {
  const bool rises = p.at(x.upper) >= p.at(x.lower);
  double lower = x.lower, upper = x.upper;
  while (lower < upper) {
    const double middle = 0.5 * (lower + upper);
    if (middle <= lower || middle >= upper) break;
    ((p.at(middle) < value) == rises ? lower : upper) = middle;
  }
  return lower;
}

// Returns a joint that others follow as a polynomial of one that follows it; unset if that bends.
std::optional<JointPolynomial> LeaderFrom(const CoupledJoint& follower) {
  if (!follower.of_leader.affine() || follower.of_leader.c[1] == 0) return std::nullopt;
  return Inverse(follower.of_leader);
}

bool Contains(std::span<const int> joints, int joint) {
  return std::find(joints.begin(), joints.end(), joint) != joints.end();
}

}  // namespace

bool AreCoupled(const mjModel* m, std::span<const int> joints) {
  for (int e = 0; e < m->neq; ++e) {
    if (m->eq_type[e] == mjEQ_JOINT &&
        (Contains(joints, m->eq_obj1id[e]) || Contains(joints, m->eq_obj2id[e])))
      return true;
  }
  return false;
}

std::vector<JointFollower> FollowersOf(const mjModel* m, std::span<const int> joints) {
  std::vector<JointFollower> out;
  if (!AreCoupled(m, joints)) return out;
  const ModelCouplings found = FindCouplings(m);
  const auto add = [&](int joint, std::size_t leader, const JointPolynomial& p) {
    const bool known = std::any_of(out.begin(), out.end(),
                                   [joint](const JointFollower& f) { return f.joint == joint; });
    if (!known && !Contains(joints, joint)) out.push_back({joint, leader, p});
  };
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (joints[i] < 0) continue;
    const CoupledJoint* own = found.Of(joints[i]);
    if (own && own->leader < 0) continue;
    const int root = own ? own->leader : joints[i];
    if (own && Contains(joints, root)) continue;  // its leader has the others
    const std::optional<JointPolynomial> to_root = own ? LeaderFrom(*own) : JointPolynomial{};
    if (!to_root) continue;
    if (own) add(root, i, *to_root);
    for (const CoupledJoint& other : found.followers) {
      if (other.leader != root || other.joint == joints[i]) continue;
      add(other.joint, i, own ? Compose(other.of_leader, *to_root) : other.of_leader);
    }
  }
  return out;
}

std::vector<ListedFollower> FollowersAmong(const mjModel* m, std::span<const int> joints) {
  std::vector<ListedFollower> out;
  if (!AreCoupled(m, joints)) return out;
  const ModelCouplings found = FindCouplings(m);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const CoupledJoint* own = found.Of(joints[i]);
    if (!own || own->leader < 0) continue;
    const auto at = std::find(joints.begin(), joints.end(), own->leader);
    if (at != joints.end()) {
      out.push_back({i, static_cast<std::size_t>(at - joints.begin()), own->of_leader});
      continue;
    }
    for (std::size_t k = 0; k < i; ++k) {
      const CoupledJoint* first = found.Of(joints[k]);
      if (!first || first->leader != own->leader) continue;
      if (const auto to_root = LeaderFrom(*first))
        out.push_back({i, k, Compose(own->of_leader, *to_root)});
      break;
    }
  }
  return out;
}

JointRange ImageOf(const JointPolynomial& p, const JointRange& x) {
  const double a = p.affine() ? AffineAt(p, x.lower) : p.at(x.lower);
  const double b = p.affine() ? AffineAt(p, x.upper) : p.at(x.upper);
  return {std::min(a, b), std::max(a, b)};
}

bool IsMonotone(const JointPolynomial& p, const JointRange& x) {
  constexpr int kPoints = 1000;       // the slope is a polynomial of degree three
  constexpr double kRounding = 1e-9;  // of the largest slope
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (int k = 0; k <= kPoints; ++k) {
    const double slope = p.slope(x.lower + (x.upper - x.lower) * k / kPoints);
    least = std::min(least, slope);
    most = std::max(most, slope);
  }
  const double rounding = kRounding * std::max(std::abs(least), std::abs(most));
  return least >= -rounding || most <= rounding;
}

JointRange RangeWithin(const JointPolynomial& p, const JointRange& leader,
                       const JointRange& follower) {
  const JointRange image = ImageOf(p, leader);
  if (image.upper < follower.lower || image.lower > follower.upper)
    return {leader.upper, leader.lower};
  if (p.affine() && p.c[1] == 0) return leader;
  if (p.affine()) {
    const JointRange within = ImageOf(Inverse(p), follower);
    return {std::max(leader.lower, within.lower), std::min(leader.upper, within.upper)};
  }
  JointRange out = leader;
  const bool rises = p.at(leader.upper) >= p.at(leader.lower);
  if (image.lower < follower.lower)
    (rises ? out.lower : out.upper) = PlaceOf(p, follower.lower, leader);
  if (image.upper > follower.upper)
    (rises ? out.upper : out.lower) = PlaceOf(p, follower.upper, leader);
  return out;
}

JointRange LimitsOf(const mjModel* m, int joint) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (!m->jnt_limited[joint]) return {-kInfinity, kInfinity};
  return {m->jnt_range[2 * joint], m->jnt_range[2 * joint + 1]};
}

}  // namespace robocell::internal
