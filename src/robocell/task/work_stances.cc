#include "robocell/task/work_stances.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <Eigen/Core>

#include "robocell/base/units.h"
#include "robocell/kinematics/chain.h"
#include "robocell/kinematics/chain_model.h"
#include "robocell/kinematics/ik_batch.h"
#include "robocell/math/rotation.h"
#include "robocell/motion/clearance.h"
#include "robocell/motion/gripper_shape.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/task_space.h"
#include "robocell/task/base_stances.h"
#include "robocell/task/floor_ways.h"
#include "robocell/task/grasp_candidates.h"

namespace robocell::internal {
namespace {

constexpr double kStanceReach = 0.93;   // of the sum of the links
constexpr double kNearestStance = 0.2;  // m from the base's origin
constexpr int kStanceRings = 10, kStanceBearings = 32;
constexpr double kStanceTurns[] = {0, 0.6, -0.6};  // rad, of the base away from the object
constexpr size_t kGraspsEach = 4;                  // that are looked for from each place
constexpr double kGraspTurnCost = 0.3;  // of a rad between the hand's present turn and a grasp
constexpr double kAboveGrasp = 0.1;     // m over a grasp, where the hand comes from and lifts to
constexpr int kStanceRestarts = 10;
constexpr double kStanceTolerance = 1e-3;

std::vector<GraspCandidate> GraspsFor(const Robot& robot, const std::string& body) {
  if (!robot.has_arm() || !robot.has_gripper() || !GripperShape::Supports(robot.gripper()))
    return {};
  const Scene scene = robot.scene();
  const auto shape = GripperShape::Of(robot.config(), scene.spec().options, scene.timestep());
  std::vector<GraspCandidate> grasps =
      FindGrasps(scene.model(), scene.data(),
                 RequireId(scene.model(), mjOBJ_BODY, body, "scene '" + scene.name() + "'"), *shape,
                 robot.tcp_in_world());
  if (grasps.empty()) grasps = FindOtherGrasps(robot, body, *shape, robot.tcp_in_world());
  return grasps;
}

// Counts the grasps in reach from each of these poses of the base.
std::vector<int> CountInReach(const Robot& robot, const std::vector<Pose>& bases,
                              const std::vector<GraspCandidate>& grasps) {
  const Chain& chain = robot.chain();
  const Pose mount = robot.base().pose().inverse() * robot.base_in_world();
  const Pose hand = robot.base_in_world().inverse() * robot.tcp_in_world();
  const size_t each = std::min(kGraspsEach, grasps.size());
  std::vector<Pose> targets;
  std::vector<std::pair<double, const GraspCandidate*>> ranked(grasps.size());
  for (const Pose& base : bases) {
    const Pose root = base * mount;
    const Pose now = root * hand;
    for (size_t g = 0; g < grasps.size(); ++g) {
      ranked[g] = {
          grasps[g].cost +
              kGraspTurnCost * AngleBetween(now.quaternion(), grasps[g].tcp_in_world.quaternion()),
          &grasps[g]};
    }
    std::ranges::partial_sort(ranked, ranked.begin() + static_cast<std::ptrdiff_t>(each), {},
                              [](const auto& rank) { return rank.first; });
    const Pose to_root = root.inverse();
    for (size_t g = 0; g < each; ++g) {
      const Pose& at = ranked[g].second->tcp_in_world;
      targets.push_back(to_root * at);
      targets.push_back(to_root * Pose(at.translation() - kAboveGrasp * ranked[g].second->approach,
                                       at.quaternion()));
    }
  }
  IkBatchOptions options;
  options.ik.tolerance = kStanceTolerance;
  options.ik.max_restarts = kStanceRestarts;
  const std::vector<double> home = robot.arm().joint_pos();
  const IkBatchResult result = IkBatch(chain, targets, home, options);
  std::vector<int> counts(bases.size(), 0);
  for (size_t b = 0; b < bases.size(); ++b) {
    for (size_t g = 0; g < each; ++g) {
      const size_t at = 2 * (b * each + g);
      counts[b] += result.success[at] != 0 && result.success[at + 1] != 0;
    }
  }
  return counts;
}

}  // namespace

bool DrivesItself(const RobotConfig& robot) {
  return robot.base.kind == BaseKind::kPlanar &&
         std::ranges::any_of(robot.move_groups.entries(), [](const auto& entry) {
           return entry.second->kind == MoveGroupKind::kBase && !entry.second->actuators.empty();
         });
}

bool StartsAnywhere(const RunConfig& run) {
  return DrivesItself(run.robot.config) && !run.start.base_distance;
}

std::optional<Vec2> DistancesInReach(const Robot& robot, const Eigen::Vector3d& target) {
  const Pose base = robot.base().pose();
  const Pose mount = base.inverse() * robot.base_in_world();
  const ChainModel& links = robot.chain().model();
  const auto& first = links.joints[0].fixed.translation;
  const Eigen::Vector3d shoulder = mount * Eigen::Vector3d(first[0], first[1], first[2]);
  const double up = target.z() - base.translation().z() - shoulder.z();
  const double reach = kStanceReach * links.reach_bound;
  if (std::abs(up) >= reach) return std::nullopt;
  const double farthest = shoulder.head<2>().norm() + std::sqrt(reach * reach - up * up);
  return Vec2{std::min(kNearestStance, farthest), farthest};
}

std::vector<WorkStance> FindWorkStances(const Robot& robot, const std::string& body) {
  const Scene scene = robot.scene();
  scene.SyncPoses();
  const Eigen::Vector3d target = scene.body_pose(body).translation();
  const std::optional<Vec2> distances = DistancesInReach(robot, target);
  if (!distances) return {};
  const double height = robot.base().pose().translation().z();
  std::vector<FloorPlace> places;
  std::vector<Pose> poses;
  for (int ring = 0; ring < kStanceRings; ++ring) {
    const double distance =
        std::lerp((*distances)[0], (*distances)[1], (ring + 0.5) / kStanceRings);
    for (int b = 0; b < kStanceBearings; ++b) {
      const double bearing = 2 * kPi * (b + 0.5 * (ring % 2)) / kStanceBearings;
      for (const double turn : kStanceTurns) {
        places.push_back({target.x() + distance * std::cos(bearing),
                          target.y() + distance * std::sin(bearing), bearing + kPi + turn});
        poses.push_back(PoseOf(places.back(), height));
      }
    }
  }
  const std::vector<bool> free = BaseStances(robot, kWayClearance).AreFree(poses);
  std::vector<WorkStance> stances;
  std::vector<Pose> bases;
  for (size_t i = 0; i < poses.size(); ++i) {
    if (!free[i]) continue;
    stances.push_back({places[i]});
    bases.push_back(poses[i]);
  }
  const std::vector<GraspCandidate> grasps = GraspsFor(robot, body);
  // An arm with few joints reaches some other rotation, which its planner finds.
  if (grasps.empty() || TaskSpaceOf(robot).is_partial(robot.chain())) return stances;
  const std::vector<int> counts = CountInReach(robot, bases, grasps);
  for (size_t i = 0; i < stances.size(); ++i) stances[i].grasps = counts[i];
  std::erase_if(stances, [](const WorkStance& stance) { return stance.grasps == 0; });
  std::ranges::stable_sort(stances, std::ranges::greater(), &WorkStance::grasps);
  return stances;
}

std::vector<Pose> DrawOnFloor(std::span<const FloorArea> floor, double height, int count,
                              Rng& rng) {
  // Other storeys, and the roof, are out of the way of a base.
  std::vector<FloorArea> level;
  double all = 0;  // square metres
  for (const FloorArea& area : floor) {
    if (std::abs(area.frame_to_world.translation().z() - height) > kMostFloorStep) continue;
    level.push_back(area);
    all += area.half_x * area.half_y;
  }
  std::vector<Pose> poses;
  for (int draw = 0; draw < count && all > 0; ++draw) {
    double at = rng.Uniform(0, all);
    size_t chosen = 0;
    while (chosen + 1 < level.size() && at > level[chosen].half_x * level[chosen].half_y) {
      at -= level[chosen].half_x * level[chosen].half_y;
      ++chosen;
    }
    const FloorArea& area = level[chosen];
    const double x = rng.Uniform(-area.half_x, area.half_x);
    const double y = rng.Uniform(-area.half_y, area.half_y);
    const Eigen::Vector3d on = area.frame_to_world * Eigen::Vector3d(x, y, 0);
    poses.push_back(Pose::FromRpy({on.x(), on.y(), height}, {0, 0, rng.Uniform(-kPi, kPi)}));
  }
  return poses;
}

}  // namespace robocell::internal
