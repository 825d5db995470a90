#include "robocell/task/contact_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "robocell/kinematics/ik_batch.h"
#include "robocell/math/rotation.h"
#include "robocell/motion/vertical_line.h"
#include "robocell/robot/task_space.h"

namespace robocell {
namespace {

constexpr size_t kContactBatch = 24;  // paths whose starts are solved at once
constexpr int kContactRestarts = 40;
constexpr size_t kLeastOut = 2;    // points of the line out that have to be free
constexpr size_t kStepsBack = 16;  // places along a path from which a way out is sought
// Largest motion of a joint from one pose of a path to the next, rad (m): a solution farther away is
// on another branch.
constexpr double kMostContactStep = 0.35;

}  // namespace

double GapOfClosedHand(const GripperShape& shape) {
  constexpr double kAjar = 0.004;  // m
  return std::min(shape.closed_gap() + kAjar, shape.open_gap());
}

ContactPathSource SourceOf(std::vector<ContactPath> paths) {
  return [paths = std::move(paths)]() mutable { return std::exchange(paths, {}); };
}

std::vector<ContactPath> AllPathsOf(const ContactPathSource& source) {
  std::vector<ContactPath> all;
  for (;;) {
    std::vector<ContactPath> more = source();
    if (more.empty()) return all;
    std::ranges::move(more, std::back_inserter(all));
  }
}

ContactMotions::ContactMotions(PlanningScene& planning, std::vector<ContactPath> paths,
                               const JointVector& home, const ContactMotionOptions& options)
    : planning_(planning),
      paths_(std::move(paths)),
      options_(options),
      home_(home),
      world_in_base_(planning.robot().base_in_world().inverse()) {}

// Solves the starts of some more paths, best first: usually one of the first is taken.
void ContactMotions::SolveMore() {
  const size_t begin = solved_, first = starts_.size();
  solved_ = std::min(begin + kContactBatch, paths_.size());
  std::vector<Pose> targets;
  for (size_t i = begin; i < solved_; ++i)
    targets.push_back(world_in_base_ * paths_[i].tcp_in_world.front());
  const Chain& chain = planning_.robot().chain();
  const internal::TaskSpace task = internal::TaskSpaceOf(planning_.robot());
  // A solution near home may have no room to follow the path: those in the middle of the limits come
  // next.
  std::vector<bool> solved(targets.size(), false);
  for (const IkPrefer prefer : {IkPrefer::kSeed, IkPrefer::kAwayFromLimits}) {
    IkBatchOptions ik;
    ik.ik.tolerance = internal::kLineIkTolerance;
    ik.ik.prefer = prefer;
    ik.ik.max_restarts = kContactRestarts;
    const IkBatchResult result = IkBatch(chain, targets, home_, ik);
    for (int b = 0; b < result.size; ++b) {
      const auto i = static_cast<size_t>(b);
      if (!result.success[b]) continue;
      solved[i] = true;
      starts_.push_back({begin + i, JointVector(result.row(b))});
    }
  }
  // An arm that cannot take every pose may turn its hand a little.
  for (size_t i = 0; i < targets.size() && task.is_partial(chain); ++i) {
    if (solved[i]) continue;
    const IkResult near = task.SolveWithin(chain, targets[i], home_, internal::kMostTilt);
    if (!near.success) continue;
    solved[i] = true;
    starts_.push_back({begin + i, near.q});
  }
  out_of_reach_ += static_cast<int>(std::ranges::count(solved, false));
  std::stable_sort(starts_.begin() + static_cast<std::ptrdiff_t>(first), starts_.end(),
                   [](const Start& a, const Start& b) { return a.path < b.path; });
}

// Returns false if there are no further paths.
bool ContactMotions::AddMore() {
  if (!options_.more) return false;
  std::vector<ContactPath> more = options_.more();
  if (more.empty()) options_.more = nullptr;
  std::ranges::move(more, std::back_inserter(paths_));
  return options_.more != nullptr;
}

// Returns the line from the end of a motion along the path, as far as it is free. Fingers that let go
// may still touch the target.
JointPath ContactMotions::WayOut(const ContactPath& path, const JointPath& along) {
  const Robot& robot = planning_.robot();
  const internal::TaskSpace task = internal::TaskSpaceOf(robot);
  const Pose end = task.is_partial(robot.chain())
                       ? robot.chain().Fk(along.back())
                       : world_in_base_ * path.tcp_in_world[along.size() - 1];
  JointPath out = internal::LineAbove(robot.chain(), task, end, along.back(),
                                      Rotate(world_in_base_.quaternion(), path.away), path.after);
  const auto blocked = std::find_if(out.begin() + 1, out.end(), [&](const JointVector& q) {
    return !planning_.IsFree(q, {.gap = path.free_gap, .touch_target = true});
  });
  if (blocked != out.end()) obstacles_.Add(planning_.obstacle());
  out.erase(blocked, out.end());
  return out;
}

std::optional<ContactMotion> ContactMotions::Try(const Start& start) {
  const ContactPath& path = paths_[start.path];
  const Chain& chain = planning_.robot().chain();
  const internal::TaskSpace task = internal::TaskSpaceOf(planning_.robot());
  const auto is_free = [&](const JointVector& q, double gap, bool touch) {
    if (planning_.IsFree(q, {.gap = gap, .touch_target = touch})) return true;
    ++in_collision_;
    obstacles_.Add(planning_.obstacle());
    return false;
  };
  ContactMotion motion{.path = start.path};
  const bool is_partial = task.is_partial(chain);  // then the rotation may be a little off
  const Pose tcp = is_partial ? chain.Fk(start.q) : world_in_base_ * path.tcp_in_world.front();
  motion.in = internal::LineAbove(chain, task, tcp, start.q,
                                  Rotate(world_in_base_.quaternion(), path.from), path.before);
  if (internal::MissingShare(motion.in) > 0) return ++no_line_, std::nullopt;
  for (size_t i = 1; i < motion.in.size(); ++i) {
    if (!is_free(motion.in[i], path.free_gap, false)) return std::nullopt;
  }
  if (!is_free(start.q, path.contact_gap, true)) return std::nullopt;
  motion.along = {start.q};
  for (size_t i = 1; i < path.tcp_in_world.size(); ++i) {
    const Pose next = world_in_base_ * path.tcp_in_world[i];
    IkResult ik = Ik(
        chain, next,
        {.tolerance = internal::kLineIkTolerance, .seed = motion.along.back(), .max_restarts = 0});
    if (!ik.success && is_partial)
      ik = task.SolveWithin(chain, next, motion.along.back(), internal::kMostTilt);
    if (!ik.success || JointDistance(ik.q, motion.along.back()) > kMostContactStep) break;
    if (!planning_.IsFree(ik.q, {.gap = path.contact_gap, .touch_target = true})) {
      obstacles_.Add(planning_.obstacle());
      break;
    }
    motion.along.push_back(ik.q);
  }
  const size_t steps = path.tcp_in_world.size();
  const auto share = [&] {
    if (steps < 2) return 1.0;
    return static_cast<double>(motion.along.size() - 1) / static_cast<double>(steps - 1);
  };
  if (share() < options_.least_share) return ++no_way_, std::nullopt;
  const size_t back = std::max<size_t>(1, motion.along.size() / kStepsBack);
  motion.out = WayOut(path, motion.along);
  // At the end of the reach there may be no way out: a hand that may stop earlier leaves from there.
  while (motion.out.size() <= kLeastOut && motion.along.size() > back) {
    motion.along.resize(motion.along.size() - back);
    if (share() < options_.least_share) break;
    motion.out = WayOut(path, motion.along);
  }
  if (motion.out.size() <= kLeastOut) return ++no_way_out_, std::nullopt;
  motion.share = share();
  std::ranges::reverse(motion.in);
  return motion;
}

std::optional<ContactMotion> ContactMotions::Next() {
  for (;;) {
    if (next_ >= starts_.size()) {
      if (solved_ >= paths_.size() && !AddMore()) break;
      SolveMore();
      continue;
    }
    std::optional<ContactMotion> motion = Try(starts_[next_++]);
    if (!motion) continue;
    if (motion->share >= 1) return motion;
    partial_.push_back(*std::move(motion));
    std::ranges::stable_sort(partial_, {}, &ContactMotion::share);
  }
  if (partial_.empty()) return std::nullopt;
  ContactMotion best = std::move(partial_.back());
  partial_.pop_back();
  return best;
}

std::string ContactMotions::Reasons() const {
  std::string text;
  const auto add = [&](int count, const std::string& what) {
    if (count > 0) text += fmt::format("{} {} {}", text.empty() ? "" : ",", count, what);
  };
  add(out_of_reach_, "out of reach");
  add(no_line_, "with no straight way to the contact");
  add(no_way_, "that the arm cannot follow");
  add(no_way_out_, "with no way out");
  add(in_collision_, "in collision" + obstacles_.Text(planning_.model()));
  // A path may have two starts.
  return fmt::format("of {} ways{}", starts_.size() + static_cast<size_t>(out_of_reach_), text);
}

}  // namespace robocell
