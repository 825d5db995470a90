#include "robocell/task/grasp_check.h"

#include <span>
#include <utility>
#include <vector>

#include "robocell/motion/gripper_shape.h"
#include "robocell/task/grasp_candidates.h"

namespace robocell {
namespace {

constexpr int kMostGrasps = 4;  // grasps in reach, at least one of which has to be usable

}  // namespace

std::optional<Refusal> GraspCheck::Check(const Scene& scene, const Robot& robot,
                                         const std::string& body, double lift_height,
                                         const GraspCondition& refuse) {
  if (!robot.has_gripper() || !GripperShape::Supports(robot.gripper())) return std::nullopt;
  if (!shape_ || robot_ != robot.name())
    shape_ = GripperShape::Of(robot.config(), scene.spec().options, scene.timestep());
  robot_ = robot.name();
  PlanningScene planning(scene, robot, body, shape_);
  std::vector<GraspCandidate> candidates =
      FindGrasps(planning.model(), planning.data(), planning.target_body(), planning.shape(),
                 robot.tcp_in_world());
  if (candidates.empty())
    candidates = FindOtherGrasps(planning.robot(), body, planning.shape(), robot.tcp_in_world());
  if (candidates.empty())
    return Refusal{.reason = kNoGrasp,
                   .detail = "the object is too large, too small or too flat for the gripper: " +
                             SizesForGrasp(planning.model(), planning.data(),
                                           planning.target_body(), planning.shape()),
                   .holds_everywhere = true};
  const std::vector<double> home = robot.arm().joint_pos();
  GraspMotions motions(planning, std::move(candidates), JointVector(std::span<const double>(home)),
                       GraspMotionsToLift(lift_height));
  std::optional<Refusal> of_no_use;
  for (int i = 0; i < kMostGrasps; ++i) {
    const std::optional<GraspMotion> motion = motions.Next();
    if (!motion) break;
    of_no_use = refuse ? refuse(planning, *motion) : std::nullopt;
    if (!of_no_use) return std::nullopt;
    planning.Update();
  }
  if (of_no_use) return of_no_use;
  return Refusal{motions.MostCollide() ? kGraspsInCollision : Refusal::kNoReachableBasePose,
                 "grasps: " + motions.Reasons()};
}

}  // namespace robocell
