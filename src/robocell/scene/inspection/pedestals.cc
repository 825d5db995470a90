// A robot should stand on its pedestal: the lowest of its fixed parts lies on the top face. The
// advice is what makes it stand there: another `reset_root_pose`, or else an edit of the root's
// pose.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <Eigen/Core>

#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scene/inspection/robot_inspection.h"
#include "robocell/scene/spec_tree.h"

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

// One robot and its pedestal. Poses of the root are those on top of it.
class PedestalCheck {
 public:
  PedestalCheck(const CompiledRobot& robot, int pedestal, int base, int root)
      : m_(robot.model),
        d_(robot.reference),
        robot_(robot),
        pedestal_(pedestal),
        root_(root),
        base_(PoseOf(base)),
        top_(Vector3d(0, 0, size()[2])) {
    int top = root;  // the body of the robot's own model that is attached
    while (m_->body_parentid[top] != base && m_->body_parentid[top] > 0)
      top = m_->body_parentid[top];
    now_ = top_.inverse() * base_.inverse() * PoseOf(top);
    own_ = FindSpecElement(robot.part.spec.get(), mjOBJ_BODY, WithoutPrefix(top));
    authored_ = own_ ? PoseInParent(own_) : now_;
  }

  // Returns "" if it stands on the pedestal, or has only joints.
  std::string Text() const {
    const FixedPart part = Measure(now_);
    if (!std::isfinite(part.low.x())) return "";
    const std::string off = HowFarOff(part, size());
    if (off.empty()) return "";
    return fmt::format("'{}' {}, because {}. {}", WithoutPrefix(root_), off,
                       IsDropped() ? "the pose that the model's file gives it is dropped"
                                   : "of the pose that the model's file gives it",
                       Remedy());
  }

 private:
  const Vec3& size() const { return *robot_.robot.base.size; }
  Pose PoseOf(int body) const {
    return Pose::FromWxyz(d_->xpos + 3 * static_cast<ptrdiff_t>(body),
                          d_->xquat + 4 * static_cast<ptrdiff_t>(body));
  }
  std::string WithoutPrefix(int body) const {
    return ElementName(m_, mjOBJ_BODY, body).substr(robot_.robot.prefix.size());
  }
  bool IsDropped() const {
    return now_.is_close(Pose(), kSame, kSame) && !authored_.is_close(Pose(), kSame, kSame);
  }

  std::string Remedy() const {
    for (const bool reset : {true, false}) {
      if (HowFarOff(Measure(reset ? Pose() : authored_), size()).empty())
        return fmt::format("Write `reset_root_pose: {}` in the robot file", reset);
    }
    const Vector3d pos = StandingPlace();
    return fmt::format(
        "Write `reset_root_pose: false` and `edits: [{{body: '{}', pos: [{:.3f}, {:.3f}, "
        "{:.3f}]}}]` "
        "in the robot file",
        own_ ? SpecName(own_) : "", pos.x() + 0.0, pos.y() + 0.0, pos.z() + 0.0);
  }

  // Returns where it stands in the middle with the rotation that its model gives it.
  Vector3d StandingPlace() const {
    const FixedPart part = Measure({Vector3d::Zero(), authored_.quaternion()});
    Vector3d pos(0, 0, size()[2] - part.low.z());
    for (const int axis : {0, 1}) {
      const double half = size()[static_cast<size_t>(axis)] / 2;
      if (part.low[axis] > half || part.high[axis] < -half)
        pos[axis] = -(part.low[axis] + part.high[axis]) / 2;
    }
    return pos;
  }

  // Measures the robot as it would be with another pose of its root.
  FixedPart Measure(const Pose& on_top) const {
    const Pose moved = top_ * on_top * now_.inverse() * top_.inverse() * base_.inverse();
    FixedPart out;
    for (int g = 0; g < m_->ngeom; ++g) {
      const int body = m_->geom_bodyid[g];
      if (g == pedestal_ || m_->geom_type[g] == mjGEOM_PLANE || !IsInSubtree(m_, body, root_) ||
          m_->body_weldid[body] != m_->body_weldid[root_])
        continue;
      const Eigen::Map<const RowMajor> geom(d_->geom_xmat + 9 * static_cast<ptrdiff_t>(g));
      const RowMajor turn = moved.rotation() * geom;
      const Vector3d place = moved * Vector3d(d_->geom_xpos + 3 * static_cast<ptrdiff_t>(g));
      if (m_->geom_type[g] == mjGEOM_MESH) {
        const int mesh = m_->geom_dataid[g];
        const float* vertices = m_->mesh_vert + 3 * static_cast<ptrdiff_t>(m_->mesh_vertadr[mesh]);
        for (int v = 0; v < m_->mesh_vertnum[mesh]; ++v) {
          const Eigen::Vector3f vertex(vertices + 3 * static_cast<ptrdiff_t>(v));
          out.Take(place + turn * vertex.cast<double>(), Vector3d::Zero());
        }
        continue;
      }
      // Middle and half sizes, in the geom's axes.
      const mjtNum* box = m_->geom_aabb + 6 * static_cast<ptrdiff_t>(g);
      out.Take(place + turn * Vector3d(box),
               HalfExtents(m_->geom_type[g], m_->geom_size + 3 * static_cast<ptrdiff_t>(g), box + 3,
                           turn));
    }
    return out;
  }

  static constexpr double kSame = 1e-9;

  const mjModel* m_;
  const mjData* d_;
  const CompiledRobot& robot_;
  int pedestal_, root_;
  Pose base_, top_;
  Pose now_, authored_;        // poses of the root
  mjsElement* own_ = nullptr;  // the root in the robot's own model
};

}  // namespace

void CheckPedestals(const CompiledRobot& robot, Findings& findings) {
  const mjModel* m = robot.model;
  const RobotRecord& record = robot.robot;
  const int pedestal = FindId(m, mjOBJ_GEOM, record.prefix + "pedestal");
  const int base = FindId(m, mjOBJ_BODY, record.base_body);
  const int root = FindId(m, mjOBJ_BODY, record.root_body);
  if (!record.base.size || pedestal < 0 || base < 0 || root < 0) return;
  const std::string text = PedestalCheck(robot, pedestal, base, root).Text();
  if (!text.empty()) findings.Warn("base", text);
}

}  // namespace robocell::internal
