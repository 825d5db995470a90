// A robot should stand on its pedestal: the lowest of its fixed parts lies on the top face.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <limits>
#include <Eigen/Core>

#include "robocell/diagnose/checks.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"

namespace robocell::internal {
namespace {

using Eigen::Vector3d;
using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

constexpr double kOff = 0.01;  // metres

// The bounding box of the robot's fixed parts, in the axes of its base.
struct FixedPart {
  Vector3d low = Vector3d::Constant(std::numeric_limits<double>::infinity());
  Vector3d high = -low;

  void Take(const Vector3d& middle, const Vector3d& half) {
    low = low.cwiseMin(middle - half);
    high = high.cwiseMax(middle + half);
  }
};

// Returns half of a shape's extent along each axis of the frame that it is rotated into. A rotated
// box around the shape would be too large: round links would seem to reach into their pedestals.
Vector3d HalfExtents(int type, const mjtNum* size, const mjtNum* half_sizes, const RowMajor& turn) {
  const Vector3d axis = turn.col(2).cwiseAbs();
  switch (type) {
    case mjGEOM_SPHERE:
      return Vector3d::Constant(size[0]);
    case mjGEOM_CAPSULE:
      return size[1] * axis + Vector3d::Constant(size[0]);
    case mjGEOM_CYLINDER: {
      const Eigen::Array3d across = (1 - axis.array().square()).max(0).sqrt();
      return size[1] * axis + size[0] * across.matrix();
    }
    case mjGEOM_ELLIPSOID:
      return (turn * Vector3d(size).asDiagonal()).rowwise().norm();
    default:
      return turn.cwiseAbs() * Vector3d(half_sizes);
  }
}

FixedPart MeasureFixedPart(const mjModel* m, const mjData* d, int base, int root, int pedestal) {
  const Eigen::Map<const RowMajor> axes(d->xmat + 9 * base);
  const Vector3d origin(d->xpos + 3 * base);
  FixedPart out;
  for (int g = 0; g < m->ngeom; ++g) {
    const int body = m->geom_bodyid[g];
    if (g == pedestal || m->geom_type[g] == mjGEOM_PLANE || !IsInSubtree(m, body, root) ||
        m->body_weldid[body] != m->body_weldid[root])
      continue;
    const Eigen::Map<const RowMajor> geom(d->geom_xmat + 9 * g);
    const RowMajor turn = axes.transpose() * geom;
    const Vector3d place = axes.transpose() * (Vector3d(d->geom_xpos + 3 * g) - origin);
    if (m->geom_type[g] == mjGEOM_MESH) {
      const int mesh = m->geom_dataid[g];
      const float* vertices = m->mesh_vert + 3 * m->mesh_vertadr[mesh];
      for (int v = 0; v < m->mesh_vertnum[mesh]; ++v) {
        const Eigen::Vector3f vertex(vertices + 3 * v);
        out.Take(place + turn * vertex.cast<double>(), Vector3d::Zero());
      }
      continue;
    }
    const mjtNum* box = m->geom_aabb + 6 * g;  // middle and half sizes, in the geom's axes
    out.Take(place + turn * Vector3d(box),
             HalfExtents(m->geom_type[g], m->geom_size + 3 * g, box + 3, turn));
  }
  return out;
}

// Returns "" if it stands on the pedestal.
std::string HowFarOff(const FixedPart& part, const Vec3& size) {
  const double height = part.low.z() - size[2];
  double beside = 0;
  for (const int axis : {0, 1}) {
    const double half = size[static_cast<size_t>(axis)] / 2;
    beside = std::max({beside, part.low[axis] - half, -half - part.high[axis]});
  }
  if (beside > kOff) return fmt::format("stands {:.3f} m beside its pedestal", beside);
  if (height > kOff) return fmt::format("is {:.3f} m above its pedestal", height);
  if (height < -kOff) return fmt::format("stands {:.3f} m deep in its pedestal", -height);
  return "";
}

}  // namespace

void CheckPedestals(const CompiledRobot& robot, Findings& findings) {
  const mjModel* m = robot.model;
  const RobotRecord& record = robot.robot;
  const int pedestal = FindId(m, mjOBJ_GEOM, record.prefix + "pedestal");
  const int base = FindId(m, mjOBJ_BODY, record.base_body);
  const int root = FindId(m, mjOBJ_BODY, record.root_body);
  if (!record.base.size || pedestal < 0 || base < 0 || root < 0) return;
  const FixedPart part = MeasureFixedPart(m, robot.reference, base, root, pedestal);
  if (!std::isfinite(part.low.x())) return;  // only joints
  const std::string off = HowFarOff(part, *record.base.size);
  if (off.empty()) return;
  findings.Warn("base",
                fmt::format("'{}' {}, because of the pose that the model's file gives it. Write "
                            "`reset_root_pose: {}` in the robot file, or correct the pose in "
                            "`edits`",
                            record.root_body.substr(record.prefix.size()), off,
                            record.config.reset_root_pose.value_or(false) ? "false" : "true"));
}

}  // namespace robocell::internal
