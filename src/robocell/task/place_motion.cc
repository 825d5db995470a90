#include "robocell/task/place_motion.h"

#include <fmt/format.h>

#include <algorithm>

#include "robocell/base/units.h"
#include "robocell/kinematics/ik_batch.h"
#include "robocell/math/rotation.h"
#include "robocell/motion/vertical_line.h"
#include "robocell/robot/task_space.h"

namespace robocell {
namespace {

constexpr int kPlaceTurns = 16;
constexpr int kPlaceRestarts = 40;
constexpr double kPlaceDrop = 0.003;  // metres

}  // namespace

Eigen::Vector3d PlaceOver(const Eigen::Vector3d& place) {
  return place + kPlaceDrop * Eigen::Vector3d::UnitZ();
}

std::vector<Pose> PosesAbout(const Eigen::Vector3d& place, const Pose& object_in_world) {
  std::vector<Pose> poses;
  for (int i = 0; i < kPlaceTurns; ++i) {
    const Pose turn =
        Pose::FromRpy(Eigen::Vector3d::Zero(), {0, 0, 2 * internal::kPi * i / kPlaceTurns});
    poses.emplace_back(place, (turn * object_in_world).quaternion());
  }
  return poses;
}

PlaceMotions::PlaceMotions(PlanningScene& planning, const Pose& object_in_tcp,
                           const std::vector<Pose>& poses, const JointVector& start,
                           const PlaceMotionOptions& options)
    : planning_(planning),
      object_in_tcp_(object_in_tcp),
      options_(options),
      count_(static_cast<int>(poses.size())) {
  const Pose world_in_base = planning_.robot().base_in_world().inverse();
  const Pose tcp_in_object = object_in_tcp_.inverse();
  std::vector<Pose> targets;
  for (const Pose& pose : poses) targets.push_back(world_in_base * pose * tcp_in_object);
  IkBatchOptions ik;
  ik.ik.tolerance = internal::kLineIkTolerance;
  ik.ik.prefer = IkPrefer::kSeed;
  ik.ik.max_restarts = kPlaceRestarts;
  const Chain& chain = planning_.robot().chain();
  const internal::TaskSpace task = internal::TaskSpaceOf(planning_.robot());
  const IkBatchResult result = IkBatch(chain, targets, start, ik);
  for (int b = 0; b < result.size; ++b) {
    if (result.success[b]) {
      candidates_.push_back({poses[b], targets[b], JointVector(result.row(b))});
      continue;
    }
    const IkResult near = task.SolveWithin(chain, targets[b], start, internal::kMostTilt);
    // The object is released with the rotation that the arm reached.
    const Pose tcp = near.success ? chain.Fk(near.q) : targets[b];
    if (near.success)
      candidates_.push_back(
          {planning_.robot().base_in_world() * tcp * object_in_tcp_, tcp, near.q});
    else
      ++out_of_reach_;
  }
  std::ranges::stable_sort(candidates_, {},
                           [&](const Candidate& c) { return JointDistance(c.q, start); });
}

std::optional<PlaceMotion> PlaceMotions::Next() {
  const Robot& robot = planning_.robot();
  const internal::TaskSpace task = internal::TaskSpaceOf(robot);
  const Eigen::Vector3d up =
      Rotate(robot.base_in_world().inverse().quaternion(), Eigen::Vector3d::UnitZ());
  while (next_ < candidates_.size()) {
    const Candidate& candidate = candidates_[next_++];
    JointPath down = internal::LineAbove(robot.chain(), task, candidate.tcp_in_base, candidate.q,
                                         up, options_.above);
    if (internal::MissingShare(down) > 0) {
      ++no_way_down_;
      continue;
    }
    std::ranges::reverse(down);
    if (IsFree(candidate, down)) return PlaceMotion{candidate.object_in_world, std::move(down)};
    ++in_collision_;
    obstacles_.Add(planning_.obstacle());
  }
  return std::nullopt;
}

// Checks the way down with the object in the hand, and the way back without it.
bool PlaceMotions::IsFree(const Candidate& candidate, const JointPath& down) {
  const auto is_free = [&](const FreedomDemand& demand) {
    return std::ranges::all_of(down,
                               [&](const JointVector& q) { return planning_.IsFree(q, demand); });
  };
  planning_.HoldTarget(object_in_tcp_);
  if (!planning_.IsFree(down.front(), {.gap = options_.gap, .clearance = options_.clearance}))
    return false;
  if (!is_free({.gap = options_.gap})) return false;
  planning_.PutTarget(candidate.object_in_world);
  const bool free_way_back = is_free({.gap = planning_.shape().open_gap(), .touch_target = true});
  planning_.HoldTarget(object_in_tcp_);
  return free_way_back;
}

std::string PlaceMotions::Reasons() const {
  std::string text;
  const auto add = [&](int count, const std::string& what) {
    if (count > 0) text += fmt::format("{} {} {}", text.empty() ? "" : ",", count, what);
  };
  add(out_of_reach_, "out of reach");
  add(no_way_down_,
      fmt::format("with no straight way down over the last {:.2f} m", options_.above));
  add(in_collision_, "in collision" + obstacles_.Text(planning_.model()));
  return fmt::format("of {} ways to put it down{}", count_, text);
}

}  // namespace robocell
