#include "robocell/task/grasp_motion.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>

#include "robocell/kinematics/ik_batch.h"
#include "robocell/motion/vertical_line.h"
#include "robocell/robot/task_space.h"

namespace robocell {
namespace {

constexpr size_t kBatch = 8;  // candidates solved at once: usually the first or second is taken
// The solution should be near home for a short path, but proving that none is nearer would take ten
// times as long.
constexpr int kRestarts = 40;
constexpr double kJustBefore =
    0.003;  // metres between the pads and the object just before they touch

constexpr double kSlip = 0.05;  // metres

}  // namespace

GraspMotionOptions GraspMotionsToLift(double height) {
  GraspMotionOptions options;
  options.lift = std::max(options.lift, height + kSlip);
  return options;
}

GraspMotions::GraspMotions(PlanningScene& planning, std::vector<GraspCandidate> candidates,
                           const JointVector& home, const GraspMotionOptions& options)
    : planning_(planning),
      candidates_(std::move(candidates)),
      home_(home),
      options_(options),
      world_in_base_(planning.robot().base_in_world().inverse()),
      up_in_base_(Rotate(world_in_base_.quaternion(), Eigen::Vector3d::UnitZ())) {
  if (candidates_.size() > static_cast<size_t>(options_.most)) candidates_.resize(options_.most);
}

void GraspMotions::SolveMore() {
  const size_t begin = solved_.size(), end = std::min(begin + kBatch, candidates_.size());
  std::vector<Pose> targets;
  for (size_t i = begin; i < end; ++i)
    targets.push_back(world_in_base_ * candidates_[i].tcp_in_world);
  IkBatchOptions options;
  options.ik.tolerance = internal::kLineIkTolerance;
  options.ik.prefer = IkPrefer::kSeed;
  options.ik.max_restarts = kRestarts;
  const Chain& chain = planning_.robot().chain();
  const internal::TaskSpace task = internal::TaskSpaceOf(planning_.robot());
  const IkBatchResult result = IkBatch(chain, targets, home_, options);
  for (int b = 0; b < result.size; ++b) {
    solved_.push_back(result.success[b] ? JointVector(result.row(b)) : JointVector());
    missed_by_.push_back(result.position_error[b]);
    if (result.success[b] || !task.is_partial(chain)) continue;
    const IkResult near =
        task.SolveWithin(chain, targets[static_cast<size_t>(b)], home_, internal::kMostTilt);
    missed_by_.back() = near.position_error;
    if (near.success) solved_.back() = near.q;
  }
}

std::optional<GraspMotion> GraspMotions::Next() {
  while (next_ < candidates_.size()) {
    if (next_ >= solved_.size()) SolveMore();
    const size_t i = next_++;
    if (solved_[i].empty()) {
      out_of_reach_.Add(missed_by_[i]);
    } else if (auto motion = TryCandidate(candidates_[i], solved_[i])) {
      return motion;
    }
  }
  return std::nullopt;
}

bool GraspMotions::IsFree(const JointVector& q, const FreedomDemand& demand) {
  if (planning_.IsFree(q, demand)) return true;
  ++in_collision_;
  obstacles_.Add(planning_.obstacle());
  return false;
}

bool GraspMotions::MostCollide() const {
  return in_collision_ > out_of_reach_.count + no_way_down_.count + no_way_up_.count;
}

std::optional<GraspMotion> GraspMotions::TryCandidate(const GraspCandidate& grasp,
                                                      const JointVector& q) {
  const GripperShape& shape = planning_.shape();
  const double open = grasp.opening > 0 ? grasp.opening : shape.open_gap();
  // Nothing but the pads may arrive first. The named fingers need not be the innermost geoms, and
  // the gap of the closed gripper is measured between the named fingers.
  const double before =
      std::min(open, grasp.width + grasp.aside + shape.closed_gap() + kJustBefore);
  // A suction cup presses on the object.
  const bool touches = shape.is_suction();
  if (!IsFree(q, {.gap = open, .touch_target = touches}) ||
      !IsFree(q, {.gap = before, .touch_target = touches}))
    return std::nullopt;
  const Chain& chain = planning_.robot().chain();
  const internal::TaskSpace task = internal::TaskSpaceOf(planning_.robot());
  // The rotation may be a little off.
  const Pose tcp = task.is_partial(chain) ? chain.Fk(q) : world_in_base_ * grasp.tcp_in_world;
  const Eigen::Vector3d back = -Rotate(world_in_base_.quaternion(), grasp.approach);
  JointPath down = internal::LineAbove(chain, task, tcp, q, back, options_.above);
  JointPath up = internal::LineAbove(chain, task, tcp, q, up_in_base_, options_.lift);
  if (const double missing = internal::MissingShare(down); missing > 0)
    return no_way_down_.Add(missing * options_.above), std::nullopt;
  if (const double missing = internal::MissingShare(up); missing > 0)
    return no_way_up_.Add(missing * options_.lift), std::nullopt;
  for (size_t i = 1; i < down.size(); ++i) {
    if (!IsFree(down[i], {.gap = open})) return std::nullopt;
  }
  for (size_t i = 1; i < up.size(); ++i) {
    if (!IsFree(up[i], {.gap = grasp.width, .touch_target = true})) return std::nullopt;
  }
  std::reverse(down.begin(), down.end());
  return GraspMotion{grasp, std::move(down), std::move(up)};
}

std::string GraspMotions::Reasons() const {
  std::string text;
  const auto add = [&](int count, const std::string& what) {
    if (count > 0) text += fmt::format("{} {} {}", text.empty() ? "" : ",", count, what);
  };
  add(out_of_reach_.count,
      fmt::format("out of reach (the nearest by {:.2f} m)", out_of_reach_.least));
  add(no_way_down_.count,
      fmt::format("whose pregrasp, {:.2f} m above, is out of reach (by {:.2f} m)", options_.above,
                  no_way_down_.least));
  add(no_way_up_.count,
      fmt::format("that cannot be lifted by {:.2f} m (the last {:.2f} m are out of "
                  "reach)",
                  options_.lift, no_way_up_.least));
  add(in_collision_, "in collision" + obstacles_.Text(planning_.model()));
  return fmt::format("of {} grasps{}", candidates_.size(), text);
}

}  // namespace robocell
