#include "robocell/kinematics/ik.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "robocell/base/error.h"
#include "robocell/kinematics/ik_descent.h"
#include "robocell/kinematics/ik_parts.h"
#include "robocell/kinematics/lane_search.h"

namespace robocell {
namespace {

// How many solutions are compared when the nearest to the seed is wanted.
constexpr int kSolutionsCompared = 8;

// Looks for several solutions and keeps the one nearest to the seed.
class NearSearch {
 public:
  NearSearch(const Chain& chain, const Transform& target, const IkOptions& options)
      : chain_(chain.model()),
        options_(options),
        target_(target),
        descent_(chain_, target_, options_),
        seed_(SeedOf(chain_, options.seed, options.locked)) {}

  IkResult Run() {
    const bool too_far = IsOutOfReach(chain_, target_, options_.tolerance);
    const int restarts =
        too_far ? std::min(options_.max_restarts, kRestartsWhenTooFar) : options_.max_restarts;
    for (int k = 0, found = 0; k <= restarts && found < kSolutionsCompared; ++k) {
      start_ = k;
      found += Try(Start(k));
    }
    best_.iterations = descent_.iterations();
    return best_;
  }

 private:
  // Start 0 is the seed. The others fill a growing part of the joint space around it.
  JointVector Start(int k) const {
    if (k == 0) return seed_;
    const double part = std::min(1.0, 0.1 * k);
    return SpreadStart(chain_, seed_, options_.locked, k, part);
  }

  // Whether a solution was found from this start.
  bool Try(JointVector q) {
    if (!descent_.Run(q.data())) {
      if (!best_.success && (best_.q.empty() || descent_.cost() < best_cost_))
        Keep(q, descent_.cost());
      return false;
    }
    UnwindTowards(chain_, seed_, options_.locked, &q);
    MoveTowardsSeed(&q);
    const double distance = DistanceToSeed(q);
    if (!best_.success || distance < best_cost_) Keep(q, distance);
    return true;
  }

  void MoveTowardsSeed(JointVector* q) {
    JointVector nearer = *q;
    if (!descent_.Approach(seed_.data(), nearer.data())) return;
    UnwindTowards(chain_, seed_, options_.locked, &nearer);
    if (DistanceToSeed(nearer) < DistanceToSeed(*q)) *q = nearer;
  }

  double DistanceToSeed(const JointVector& q) const {
    double sum = 0;
    for (int i = 0; i < chain_.n; ++i) {
      const double d = (q[i] - seed_[i]) / (chain_.joints[i].slide ? chain_.length : 1);
      sum += d * d;
    }
    return sum;
  }

  // Makes q the answer and judges it by a fresh forward kinematics.
  void Keep(JointVector q, double cost) {
    UnwindTowards(chain_, seed_, options_.locked, &q);
    best_ = Judged(chain_, target_, options_, q);
    best_.restarts = start_;
    best_cost_ = cost;
  }

  const ChainModel& chain_;
  const IkOptions& options_;
  Transform target_;
  IkDescent descent_;
  JointVector seed_;
  int start_ = 0;
  IkResult best_;
  double best_cost_ = std::numeric_limits<double>::infinity();
};

void CheckCount(std::string_view what, int value) {
  if (value < 0)
    throw ArgumentError(
        fmt::format("inverse kinematics: {} is {}; it must be 0 or more", what, value));
}

}  // namespace

LockedJoints LockJoints(const Chain& chain, std::span<const std::string> names) {
  LockedJoints locked{};
  for (const std::string& name : names) locked[chain.joint_index(name)] = true;
  return locked;
}

bool IsFinite(const Pose& pose) {
  const Quaternion& q = pose.quaternion();
  return pose.translation().allFinite() && std::isfinite(q[0] + q[1] + q[2] + q[3]);
}

void CheckIkTarget(const Pose& tip_in_base, std::string_view name) {
  if (IsFinite(tip_in_base)) return;
  throw ArgumentError(fmt::format("inverse kinematics: {} has a number that is not finite", name));
}

void CheckIkOptions(const Chain& chain, const IkOptions& options) {
  const JointVector& seed = options.seed;
  if (!seed.empty() && seed.size() != chain.n_joints()) {
    throw ArgumentError(
        fmt::format("inverse kinematics of {}: seed: expected {} joint values, got {}",
                    chain.description(), chain.n_joints(), seed.size()));
  }
  for (int i = 0; i < chain.n_joints(); ++i) {
    const std::string& name = chain.joints()[i].name;
    if (!seed.empty() && !std::isfinite(seed[i])) {
      throw ArgumentError(
          fmt::format("inverse kinematics: seed of joint '{}' is {}", name, seed[i]));
    }
    if (seed.empty() && options.locked[i]) {
      throw ArgumentError(
          fmt::format("inverse kinematics: joint '{}' is locked, but there is no seed that says "
                      "where. Give a seed.",
                      name));
    }
  }
  if (!(options.tolerance > 0 && std::isfinite(options.tolerance))) {
    throw ArgumentError(fmt::format("inverse kinematics: tolerance is {}; it must be more than 0",
                                    options.tolerance));
  }
  CheckCount("max_restarts", options.max_restarts);
  CheckCount("max_iterations", options.max_iterations);
}

IkResult Ik(const Chain& chain, const Pose& tip_in_base, const IkOptions& options) {
  CheckIkTarget(tip_in_base, "target");
  CheckIkOptions(chain, options);
  const Transform target = ToTransform(tip_in_base);
  if (!options.prefer_near_seed) return SearchInLanes(chain, target, options);
  return NearSearch(chain, target, options).Run();
}

}  // namespace robocell
