#include "robocell/motion/robot_outline.h"

#include <mujoco/mujoco.h>

#include <cmath>

#include "robocell/motion/geom_extent.h"

namespace robocell::internal {
namespace {

using Rectangle = Eigen::AlignedBox2d;

// Returns true if a rectangle turned by `yaw` and moved by `at` is separate from one that is not,
// by the separating axes of both (Gottschalk, Lin and Manocha 1996).
bool AreApart(const Rectangle& turned, const Eigen::Vector2d& at, double yaw,
              const Rectangle& still) {
  const Eigen::Rotation2Dd rotation(yaw);
  const Eigen::Vector2d between = at + rotation * turned.center() - still.center();
  const Eigen::Vector2d half = turned.sizes() / 2, still_half = still.sizes() / 2;
  const double c = std::abs(std::cos(yaw)), s = std::abs(std::sin(yaw));
  const Eigen::Vector2d in_turned = rotation.inverse() * between;
  return std::abs(between.x()) > still_half.x() + c * half.x() + s * half.y() ||
         std::abs(between.y()) > still_half.y() + s * half.x() + c * half.y() ||
         std::abs(in_turned.x()) > half.x() + c * still_half.x() + s * still_half.y() ||
         std::abs(in_turned.y()) > half.y() + s * still_half.x() + c * still_half.y();
}

}  // namespace

RobotOutline::RobotOutline(const Robot& robot) {
  const mjModel* m = robot.scene().model();
  const mjData* d = robot.scene().data();
  const Pose base = robot.base().pose();
  const Eigen::Matrix3d axes = base.rotation();
  const Eigen::Vector3d origin = axes.transpose() * base.translation();
  for (const int g : robot.collision_geom_ids()) {
    // The pedestal of a mocap base collides with nothing in the engine, but takes up space.
    if (!IsCollisionGeom(m, g) && m->body_mocapid[m->geom_bodyid[g]] < 0) continue;
    Eigen::AlignedBox3d box;
    for (int i = 0; i < 3; ++i) {
      const Interval extent = GeomExtent(m, d, g, axes.col(i));
      box.min()[i] = extent.lower - origin[i];
      box.max()[i] = extent.upper - origin[i];
    }
    boxes_.push_back(box);
  }
}

bool RobotOutline::IsClearOf(const LevelArea& obstacle, const Pose& base_in_world,
                             double margin) const {
  const Pose base = obstacle.frame_to_world.inverse() * base_in_world;
  const Eigen::Vector3d& at = base.translation();
  const Eigen::Vector3d ahead = base.rotation().col(0);
  const double yaw = std::atan2(ahead.y(), ahead.x());
  const Eigen::Vector2d half(obstacle.half_x + margin, obstacle.half_y + margin);
  for (const Eigen::AlignedBox3d& box : boxes_) {
    const bool beside =
        box.min().z() + at.z() <= margin && box.max().z() + at.z() >= -obstacle.thickness - margin;
    if (!beside) continue;
    const Rectangle flat(box.min().head<2>(), box.max().head<2>());
    if (!AreApart(flat, at.head<2>(), yaw, Rectangle(-half, half))) return false;
  }
  return true;
}

}  // namespace robocell::internal
