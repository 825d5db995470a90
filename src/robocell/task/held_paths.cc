#include "robocell/task/held_paths.h"

#include <mujoco/mujoco.h>

#include <algorithm>

#include "robocell/mujoco/names.h"
#include "robocell/robot/robot.h"
#include "robocell/scenes/insertion.h"
#include "robocell/scenes/landmarks.h"
#include "robocell/task/pouring.h"
#include "robocell/task/wiping.h"

namespace robocell::internal {
namespace {

constexpr int kInsertions = 16;  // poses in the hole that are tried

std::vector<HeldPath> InsertPaths(const Scene& scene, const StatedRelation& stated,
                                  const BoundRelation& bound, const Pose& lifted) {
  const Eigen::Vector3d out =
      Insertion(scene, stated.subject, stated.reference).mouth().rotation().col(2);
  const double depth = Insertion(scene, stated.subject, stated.reference).full_depth();
  Rng rng = Rng::Stream(0, "places of a goal", stated.subject);
  std::vector<Pose> inserted = bound.Sample(rng, kInsertions).poses;
  std::ranges::stable_sort(inserted, {}, [&](const Pose& pose) {
    return AngleBetween(pose.quaternion(), lifted.quaternion());
  });
  std::vector<HeldPath> paths;
  for (const Pose& pose : inserted) {
    HeldPath path = {Pose((depth + kOverHole) * out) * pose};
    AppendStraight(path, pose);
    paths.push_back(std::move(path));
  }
  return paths;
}

}  // namespace

bool HasHeldPaths(const StatedRelation& stated) {
  return stated.relation == "inserted" || stated.relation == "wiped" ||
         stated.relation == "poured_into";
}

std::vector<HeldPath> HeldPaths(const Scene& scene, const StatedRelation& stated,
                                const BoundRelation& bound, const Pose& lifted) {
  if (stated.relation == "inserted") return InsertPaths(scene, stated, bound, lifted);
  if (stated.relation == "wiped") return WipePaths(scene, stated, lifted);
  return PourPaths(scene, stated, lifted);
}

std::optional<Refusal> CheckHeldPaths(const Scene& scene, const StatedRelation& stated,
                                      const BoundRelation& bound, PlanningScene& planning,
                                      const GraspMotion& motion) {
  const Robot& robot = planning.robot();
  const int body = RequireObjectOrBody(scene, stated.subject);
  const Pose object = scene.body_pose(ElementName(scene.model(), mjOBJ_BODY, body));
  const Pose in_tcp = motion.grasp.tcp_in_world.inverse() * object;
  const Pose lifted = robot.base_in_world() * robot.chain().Fk(motion.up.back()) * in_tcp;
  HeldMotions motions(planning, in_tcp, HeldPaths(scene, stated, bound, lifted), motion.up.back(),
                      {.gap = motion.grasp.width});
  if (motions.Next()) return std::nullopt;
  return Refusal{.reason = kNoHeldMotion, .detail = motions.Reasons()};
}

}  // namespace robocell::internal
