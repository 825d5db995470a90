#include "robocell/expert/pick_plan.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <string>
#include <utility>

#include "robocell/mujoco/names.h"
#include "robocell/task/grasp_candidates.h"

#include "robocell/robot/task_space.h"

namespace robocell {
namespace {

constexpr double kViaAbove = 0.05;  // height of the way point over the start, above the pregrasp
constexpr int kMostRejected = 12;   // grasps after which the task could not go on
constexpr double kViaRise = 0.02;   // ... and at least this above the start
constexpr double kSameGrasp = 0.005,
                 kSameTurn = 0.25;  // metres and rad: nearer grasps count as one

class Approach {
 public:
  Approach(PlanningScene& planning, const PickPlanRequest& request, Rng& rng)
      : planning_(planning), request_(request), rng_(rng) {}

  std::optional<JointPath> Find(const GraspMotion& motion) {
    const JointVector& goal = motion.down.front();
    const std::optional<double> clearance = LargestClearance(goal);
    if (!clearance) return std::nullopt;
    const FreeFunction is_free = [&](const JointVector& q) { return IsFree(q, *clearance); };
    if (EdgeIsFree(request_.start, goal, is_free)) return JointPath{request_.start, goal};
    if (auto path = OverTheStart(motion, is_free)) return path;
    return ConnectTrees(request_.start, goal, planning_.robot().joint_limits(), is_free, rng_);
  }

 private:
  bool IsFree(const JointVector& q, double clearance) {
    return planning_.IsFree(q, {.gap = planning_.shape().open_gap(), .clearance = clearance});
  }

  std::optional<double> LargestClearance(const JointVector& goal) {
    for (const double clearance : kPathClearances) {
      if (IsFree(request_.start, clearance) && IsFree(goal, clearance)) return clearance;
    }
    return std::nullopt;
  }

  // Returns a path straight up from the start, keeping its turn or taking that of the grasp, then
  // across.
  std::optional<JointPath> OverTheStart(const GraspMotion& motion, const FreeFunction& is_free) {
    const JointVector& goal = motion.down.front();
    Eigen::Vector3d over = request_.tcp_now.translation();
    const double grasp_height = motion.grasp.tcp_in_world.translation().z();
    over.z() = std::max(grasp_height + request_.motion.above + kViaAbove, over.z() + kViaRise);
    const Pose world_in_base = planning_.robot().base_in_world().inverse();
    const internal::TaskSpace task = internal::TaskSpaceOf(planning_.robot());
    for (const Pose& turn : {request_.tcp_now, motion.grasp.tcp_in_world}) {
      const IkResult via =
          task.Solve(planning_.robot().chain(), world_in_base * Pose(over, turn.quaternion()),
                     {.tolerance = 1e-3,
                      .seed = request_.start,
                      .prefer = IkPrefer::kSeed,
                      .max_restarts = 8});
      if (!via.success) continue;
      if (EdgeIsFree(request_.start, via.q, is_free) && EdgeIsFree(via.q, goal, is_free)) {
        return JointPath{request_.start, via.q, goal};
      }
    }
    return std::nullopt;
  }

  PlanningScene& planning_;
  const PickPlanRequest& request_;
  Rng& rng_;
};

Pose BodyPose(const PlanningScene& planning) {
  const int body = planning.target_body();
  return Pose::FromTranslationAndMatrix(planning.data()->xpos + 3 * body,
                                        planning.data()->xmat + 9 * body);
}

// A grasp with left and right finger exchanged is the same grasp.
void RemoveFailed(std::vector<GraspCandidate>& candidates, const std::vector<Pose>& failed,
                  const PlanningScene& planning) {
  const Pose world_in_object = BodyPose(planning).inverse();
  const Pose& grasp_in_tcp = planning.shape().grasp_in_tcp();
  const Pose flip =
      grasp_in_tcp * Pose(Eigen::Vector3d::Zero(), Quaternion{0, 0, 1, 0}) * grasp_in_tcp.inverse();
  std::erase_if(candidates, [&](const GraspCandidate& candidate) {
    const Pose grasp = world_in_object * candidate.tcp_in_world;
    return std::any_of(failed.begin(), failed.end(), [&](const Pose& f) {
      return f.is_close(grasp, kSameTurn, kSameGrasp) ||
             (f * flip).is_close(grasp, kSameTurn, kSameGrasp);
    });
  });
}

}  // namespace

PickPlanResult PlanPick(PlanningScene& planning, const PickPlanRequest& request, Rng& rng) {
  Approach approach(planning, request, rng);
  bool any = false, any_rejected = false;
  int searches = 0;
  const auto find = [&](std::vector<GraspCandidate> candidates) -> std::optional<PickPlan> {
    RemoveFailed(candidates, request.avoid, planning);
    any = any || !candidates.empty();
    GraspMotions motions(planning, std::move(candidates), request.home, request.motion);
    for (int i = 0, rejected = 0; i < kMostPathSearches && rejected < kMostRejected;) {
      std::optional<GraspMotion> motion = motions.Next();
      if (!motion) break;
      if (request.usable) {
        const bool is_usable = request.usable(planning, *motion);
        planning.Update();
        if (!is_usable) {
          any_rejected = true;
          ++rejected;
          continue;
        }
      }
      ++i;
      ++searches;
      if (auto path = approach.Find(*motion)) return PickPlan{std::move(*motion), std::move(*path)};
    }
    return std::nullopt;
  };
  if (auto plan = find(FindGrasps(planning.model(), planning.data(), planning.target_body(),
                                  planning.shape(), request.tcp_now)))
    return {.plan = std::move(plan), .failure = {}};
  // From above there is no way: from the sides there may be one.
  const std::string body = ElementName(planning.model(), mjOBJ_BODY, planning.target_body());
  if (auto plan = find(FindOtherGrasps(planning.robot(), body, planning.shape(), request.tcp_now)))
    return {.plan = std::move(plan), .failure = {}};
  if (!any) return {.plan = {}, .failure = "no grasp on the object"};
  if (searches == 0 && any_rejected)
    return {.plan = {}, .failure = "no grasp from which the goal can be reached"};
  return {.plan = {}, .failure = searches > 0 ? "no free path to a grasp" : "no grasp in reach"};
}

}  // namespace robocell
