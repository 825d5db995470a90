#include "robocell/task/grasp_check.h"

#include <span>
#include <utility>
#include <vector>

#include "robocell/motion/gripper_shape.h"
#include "robocell/robot/acting_arms.h"
#include "robocell/task/grasp_candidates.h"

namespace robocell {
namespace {

constexpr int kMostGrasps = 4;  // grasps in reach, at least one of which has to be usable

}  // namespace

std::optional<Refusal> GraspCheck::Check(const Scene& scene, const Robot& robot,
                                         const std::string& body, double lift_height,
                                         const GraspCondition& refuse, bool sides_too) {
  if (!robot.has_gripper() || !GripperShape::Supports(robot.gripper())) return std::nullopt;
  const std::string acting = internal::ActingName(robot);
  if (!shape_ || robot_ != acting)
    shape_ = GripperShape::Of(robot.config(), scene.spec().options, scene.timestep());
  robot_ = acting;
  PlanningScene planning(scene, robot, body, shape_);
  const JointVector home(std::span<const double>(robot.arm().joint_pos()));
  // Returns why none of them can be used.
  bool most_collide = false, is_useless = false;
  const auto refusal_of = [&](std::vector<GraspCandidate> candidates) -> std::optional<Refusal> {
    if (candidates.empty())
      return Refusal{.reason = kNoGrasp,
                     .detail = "the object is too large, too small or too flat for the gripper: " +
                               SizesForGrasp(planning.model(), planning.data(),
                                             planning.target_body(), planning.shape()),
                     .holds_everywhere = true};
    GraspMotions motions(planning, std::move(candidates), home, GraspMotionsToLift(lift_height));
    std::optional<Refusal> of_no_use;
    for (int i = 0; i < kMostGrasps; ++i) {
      const std::optional<GraspMotion> motion = motions.Next();
      if (!motion) break;
      of_no_use = refuse ? refuse(planning, *motion) : std::nullopt;
      if (!of_no_use) return std::nullopt;
      planning.Update();
    }
    is_useless = of_no_use.has_value();
    if (of_no_use) return of_no_use;
    most_collide = motions.MostCollide();
    return Refusal{most_collide ? kGraspsInCollision : Refusal::kNoReachableBasePose,
                   "grasps: " + motions.Reasons()};
  };
  const std::optional<Refusal> refusal =
      refusal_of(FindGrasps(planning.model(), planning.data(), planning.target_body(),
                            planning.shape(), robot.tcp_in_world()));
  // Out of reach from above is out of reach from the sides.
  const bool are_sides_worth = most_collide || (sides_too && is_useless);
  if (!refusal || (refusal->reason != kNoGrasp && !are_sides_worth)) return refusal;
  std::vector<GraspCandidate> others =
      FindOtherGrasps(planning.robot(), body, planning.shape(), robot.tcp_in_world());
  if (others.empty()) return refusal;
  std::optional<Refusal> of_others = refusal_of(std::move(others));
  if (!of_others) return std::nullopt;
  // An object that can be grasped from its sides is not too large: what stops these grasps counts.
  Refusal here = refusal->reason == kNoGrasp ? *of_others : *refusal;
  here.holds_everywhere = false;  // its sides may be in reach from elsewhere
  return here;
}

}  // namespace robocell
