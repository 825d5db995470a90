#include "robocell/task/push_motion.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/names.h"
#include "robocell/scenes/landmarks.h"

namespace robocell::internal {
namespace {

constexpr double kBehindObject = 0.045;  // m between the object and the fingertips that come down
constexpr double kPushStep = 0.005;      // m
constexpr double kTipShare = 0.3;        // height of the tips as a share of the object's
constexpr double kLowestTip = 0.008, kHighestTip = 0.03;  // m over what it lies on
constexpr double kTipsApart = 0.55;  // distance of the tips as a share of the object's width

Interval ObjectExtent(const Scene& scene, int body, const Eigen::Vector3d& direction) {
  Interval all{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const int geom : CollisionGeomsOf(scene.model(), body)) {
    const Interval extent = GeomExtent(scene.model(), scene.data(), geom, direction);
    all.lower = std::min(all.lower, extent.lower);
    all.upper = std::max(all.upper, extent.upper);
  }
  return all;
}

}  // namespace

std::vector<ContactPath> PushPaths(const Scene& scene, const std::string& object,
                                   const Eigen::Vector2d& place, const GripperShape& shape) {
  scene.SyncPoses();
  const int body = RequireObjectOrBody(scene, object);
  const Eigen::Vector3d middle(scene.data()->subtree_com + 3 * body);
  const Eigen::Vector2d way = place - middle.head<2>();
  std::vector<ContactPath> paths;
  if (way.norm() < 1e-4) return paths;
  const Eigen::Vector3d along(way.x() / way.norm(), way.y() / way.norm(), 0);
  const Eigen::Vector3d across = Eigen::Vector3d::UnitZ().cross(along);
  const double back = middle.dot(along) - ObjectExtent(scene, body, along).lower;
  const Interval wide = ObjectExtent(scene, body, across);
  const Interval high = ObjectExtent(scene, body, Eigen::Vector3d::UnitZ());
  const double tip_height =
      high.lower + std::clamp(kTipShare * (high.upper - high.lower), kLowestTip, kHighestTip);
  const double apart =
      std::clamp(kTipsApart * (wide.upper - wide.lower), GapOfClosedHand(shape), shape.open_gap());
  const double length = kBehindObject + way.norm();
  const int steps = std::max(2, static_cast<int>(std::ceil(length / kPushStep)));
  for (const bool side_by_side : {true, false}) {
    // One behind the other, the closed fingers push as one.
    const double gap = side_by_side ? apart : GapOfClosedHand(shape);
    const Eigen::Vector3d pad = shape.PadAt(gap);
    const Eigen::Vector3d tip(pad.x(), pad.y(), std::max(shape.TipAt(gap), pad.z()));
    for (const double side : {1.0, -1.0}) {
      Eigen::Matrix3d axes;
      axes.col(2) = -Eigen::Vector3d::UnitZ();
      axes.col(1) = side * (side_by_side ? across : along);
      axes.col(0) = axes.col(1).cross(axes.col(2));
      ContactPath path{.before = 0.08, .after = 0.08, .free_gap = gap, .contact_gap = gap};
      for (int i = 0; i <= steps; ++i) {
        Eigen::Vector3d at = middle + (length * i / steps - back - kBehindObject) * along;
        at.z() = tip_height;
        path.tcp_in_world.push_back(Pose(at - axes * tip, axes) * shape.grasp_in_tcp().inverse());
      }
      paths.push_back(std::move(path));
    }
  }
  return paths;
}

std::optional<Refusal> CheckPush(const Scene& scene, const Robot& robot, const std::string& object,
                                 const Eigen::Vector2d& place) {
  if (!robot.has_gripper() || !GripperShape::Supports(robot.gripper())) return std::nullopt;
  const auto shape = GripperShape::Of(robot.config(), scene.spec().options, scene.timestep());
  std::vector<ContactPath> paths = PushPaths(scene, object, place, *shape);
  if (paths.empty())
    return Refusal{.reason = kNoPush, .detail = fmt::format("'{}' is at the place", object)};
  const int body = RequireObjectOrBody(scene, object);
  PlanningScene planning(scene, robot, ElementName(scene.model(), mjOBJ_BODY, body), shape);
  const std::vector<double> home = robot.arm().joint_pos();
  ContactMotions motions(planning, std::move(paths), JointVector(std::span<const double>(home)));
  if (motions.Next()) return std::nullopt;
  return Refusal{.reason = Refusal::kNoReachableBasePose, .detail = motions.Reasons()};
}

}  // namespace robocell::internal
