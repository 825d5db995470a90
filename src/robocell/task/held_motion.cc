#include "robocell/task/held_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "robocell/kinematics/ik_batch.h"
#include "robocell/motion/vertical_line.h"
#include "robocell/robot/task_space.h"

namespace robocell::internal {
namespace {

constexpr int kHeldRestarts = 40;
// Largest motion of a joint from one pose of a path to the next, rad (m): a solution farther away is
// on another branch.
constexpr double kMostHeldStep = 0.3;
constexpr double kHereRad = 0.03, kHereMetres = 0.01;
constexpr double kStraightStep = 0.005, kStraightTurn = 0.05;  // m and rad

}  // namespace

void AppendStraight(HeldPath& path, const Pose& to) {
  const Pose from = path.back();
  const double metres = (to.translation() - from.translation()).norm();
  const double radians = AngleBetween(from.quaternion(), to.quaternion());
  const int steps = std::max(
      1, static_cast<int>(std::ceil(std::max(metres / kStraightStep, radians / kStraightTurn))));
  for (int i = 1; i <= steps; ++i)
    path.push_back(from.interpolate(to, static_cast<double>(i) / steps));
}

HeldMotions::HeldMotions(PlanningScene& planning, const Pose& object_in_tcp,
                         std::vector<HeldPath> paths, const JointVector& start,
                         const HeldMotionOptions& options)
    : planning_(planning),
      tcp_in_object_(object_in_tcp.inverse()),
      world_in_base_(planning.robot().base_in_world().inverse()),
      paths_(std::move(paths)),
      options_(options) {
  planning_.HoldTarget(object_in_tcp);
  const Chain& chain = planning_.robot().chain();
  const Pose tcp = chain.Fk(start);
  std::vector<Pose> targets;
  std::vector<size_t> searched;
  for (size_t i = 0; i < paths_.size(); ++i) {
    const Pose target = world_in_base_ * paths_[i].front() * tcp_in_object_;
    // A path that begins where the object is goes on with the present posture.
    if (target.is_close(tcp, kHereRad, kHereMetres)) {
      starts_.push_back({i, start});
      continue;
    }
    targets.push_back(target);
    searched.push_back(i);
  }
  if (targets.empty()) return;
  // A solution near the present one may have no room to follow the path: those in the middle of the
  // limits come next.
  std::vector<bool> solved(targets.size(), false);
  for (const IkPrefer prefer : {IkPrefer::kSeed, IkPrefer::kAwayFromLimits}) {
    IkBatchOptions ik;
    ik.ik.tolerance = kLineIkTolerance;
    ik.ik.prefer = prefer;
    ik.ik.max_restarts = kHeldRestarts;
    const IkBatchResult result = IkBatch(chain, targets, start, ik);
    for (int b = 0; b < result.size; ++b) {
      if (!result.success[b]) continue;
      solved[static_cast<size_t>(b)] = true;
      starts_.push_back({searched[static_cast<size_t>(b)], JointVector(result.row(b))});
    }
  }
  // An arm that cannot take every pose may turn the object a little.
  const TaskSpace task = TaskSpaceOf(planning_.robot());
  for (size_t i = 0; i < targets.size() && task.is_partial(chain); ++i) {
    if (solved[i]) continue;
    const IkResult near = task.SolveWithin(chain, targets[i], start, kMostTilt);
    if (!near.success) continue;
    solved[i] = true;
    starts_.push_back({searched[i], near.q});
  }
  out_of_reach_ = static_cast<int>(std::ranges::count(solved, false));
  std::ranges::stable_sort(starts_, {}, &Start::path);
}

std::optional<HeldMotion> HeldMotions::Try(size_t path, const JointVector& q) {
  const Chain& chain = planning_.robot().chain();
  const TaskSpace task = TaskSpaceOf(planning_.robot());
  HeldMotion motion{.path = path, .along = {q}};
  const auto is_free = [&](const JointVector& at) {
    if (planning_.IsFree(at, {.gap = options_.gap})) return true;
    ++in_collision_;
    obstacles_.Add(planning_.obstacle());
    return false;
  };
  // The whole way first: it costs less than the collisions.
  for (size_t i = 1; i < paths_[path].size(); ++i) {
    const Pose next = world_in_base_ * paths_[path][i] * tcp_in_object_;
    IkResult ik =
        Ik(chain, next,
           {.tolerance = kLineIkTolerance, .seed = motion.along.back(), .max_restarts = 0});
    if (!ik.success && task.is_partial(chain))
      ik = task.SolveWithin(chain, next, motion.along.back(), kMostTilt);
    if (!ik.success || JointDistance(ik.q, motion.along.back()) > kMostHeldStep) {
      ++no_way_;
      return std::nullopt;
    }
    motion.along.push_back(ik.q);
  }
  if (!std::ranges::all_of(motion.along, is_free)) return std::nullopt;
  return motion;
}

std::optional<HeldMotion> HeldMotions::Next() {
  while (next_ < starts_.size()) {
    const Start& start = starts_[next_++];
    if (std::optional<HeldMotion> motion = Try(start.path, start.q)) return motion;
  }
  return std::nullopt;
}

std::string HeldMotions::Reasons() const {
  std::string text;
  const auto add = [&](int count, const std::string& what) {
    if (count > 0) text += fmt::format("{} {} {}", text.empty() ? "" : ",", count, what);
  };
  add(out_of_reach_, "out of reach");
  add(no_way_, "that the arm cannot follow");
  add(in_collision_, "in collision" + obstacles_.Text(planning_.model()));
  return fmt::format("of {} ways{}", starts_.size() + static_cast<size_t>(out_of_reach_), text);
}

}  // namespace robocell::internal
