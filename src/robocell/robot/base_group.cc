#include "robocell/robot/base_group.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>
#include <Eigen/LU>

#include "robocell/base/error.h"
#include "robocell/base/log.h"
#include "robocell/base/units.h"
#include "robocell/math/rotation.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/driven_base.h"
#include "robocell/robot/joint_group.h"
#include "robocell/robot/planar_motion.h"
#include "robocell/robot/robot.h"
#include "robocell/robot/wheeled_base.h"

namespace robocell::internal {
namespace {

constexpr double kInPlane = 1e-6;  // m and rad; numbers in files are rounded

constexpr double kNowhere = 1e-6;  // m
constexpr double kLever = 0.1;     // m from the base to the held object, for rotations

double Displacement(const Pose& from, const Pose& to) {
  return (to.translation() - from.translation()).norm() +
         kLever * AngleBetween(from.quaternion(), to.quaternion());
}

class FixedBase : public JointGroupOf<BaseGroup> {
 public:
  FixedBase(const Scene& scene, GroupNames names)
      : JointGroupOf(scene, std::move(names), MoveGroupKind::kBase) {}
  Pose pose() const override { return leaf_frame_to_world(); }
  void SetPose(const Pose&) override {
    throw ArgumentError(core().place() +
                        ": a fixed base cannot be moved; give the robot `base: {kind: mocap}` to "
                        "place it");
  }
  bool is_mobile() const override { return false; }
};

// Mocap and free bodies, which Scene moves by name.
class MovableBody : public JointGroupOf<BaseGroup> {
 public:
  MovableBody(const Scene& scene, GroupNames names, BaseKind base)
      : JointGroupOf(scene, std::move(names), MoveGroupKind::kBase), base_(base) {}
  Pose pose() const override { return leaf_frame_to_world(); }
  void SetPose(const Pose& pose) override {
    Scene(core().scene()).SetBodyPose(core().names().leaf.name, pose);
  }
  bool is_mobile() const override { return base_ == BaseKind::kFree; }

 private:
  BaseKind base_;
};

// Two slides and a hinge about z, in any order, in the frame that the base is attached to.
class PlanarBase : public JointGroupOf<BaseGroup>, public PlanarMotion {
 public:
  PlanarBase(const Scene& scene, GroupNames names)
      : JointGroupOf(scene, std::move(names), MoveGroupKind::kBase) {
    const mjModel* m = core().model();
    int hinges = 0;
    for (const int joint : core().joint_ids()) hinges += m->jnt_type[joint] == mjJNT_HINGE;
    if (nq() == 3 && hinges == 1) return;
    throw ArgumentError(
        fmt::format("{}: a planar base has the joints x, y and yaw, this one has {} joint values{}",
                    core().place(), nq(), nq() == 3 ? ", and not one of a hinge" : ""));
  }
  Pose pose() const override { return leaf_frame_to_world(); }
  void SetPose(const Pose& pose) override {
    std::array<double, 3> present;
    GetJointPos(present);
    const std::vector<double> q = JointsAt(pose, present);
    leaving_.Warn(core().scene(), core().names().robot, place(), BaseKind::kPlanar, this->pose(),
                  pose);
    SetJointVel(std::array{0.0, 0.0, 0.0});
    SetJointPos(q);
  }
  bool is_mobile() const override { return true; }

  std::vector<double> JointsAt(const Pose& pose, std::span<const double> near) const override {
    const mjModel* m = core().model();
    const std::vector<int>& joints = core().joint_ids();
    size_t hinge = 0;
    std::vector<double> q(3);
    std::vector<size_t> slides;
    for (size_t i = 0; i < 3; ++i) {
      q[i] = m->qpos0[m->jnt_qposadr[joints[i]]];
      if (m->jnt_type[joints[i]] == mjJNT_HINGE)
        hinge = i;
      else
        slides.push_back(i);
    }
    std::array<double, 3> present;
    GetJointPos(present);
    const Pose mount = this->pose() * Moved(present).inverse();
    const Pose wanted = mount.inverse() * pose;
    const Eigen::Vector3d rpy = wanted.rpy();
    const double up = m->jnt_axis[3 * joints[hinge] + 2] < 0 ? -1 : 1;
    q[hinge] += up * rpy[2];
    // The slides move along straight lines, whose directions the turn may change.
    const Eigen::Vector3d from = Moved(q).translation();
    Eigen::Matrix2d along;
    for (size_t i = 0; i < 2; ++i) {
      std::vector<double> moved = q;
      moved[slides[i]] += 1;
      along.col(static_cast<Eigen::Index>(i)) = (Moved(moved).translation() - from).head<2>();
    }
    const Eigen::Vector3d way = wanted.translation() - from;
    const Eigen::Vector2d slid = along.inverse() * way.head<2>();
    for (size_t i = 0; i < 2; ++i) q[slides[i]] += slid[static_cast<Eigen::Index>(i)];
    if (std::abs(way.z()) > kInPlane || std::hypot(rpy[0], rpy[1]) > kInPlane) {
      throw ArgumentError(
          fmt::format("{}: a planar base moves in its plane only; the pose is "
                      "{:.4g} m above it and tilted by {:.4g} rad",
                      core().place(), way.z(), std::hypot(rpy[0], rpy[1])));
    }
    q[hinge] = NearestTurn(joints[hinge], q[hinge], near[hinge]);
    for (size_t i = 0; i < 3; ++i) RequireInRange(joints[i], joint_names()[i], q[i]);
    return q;
  }

 private:
  // Returns what joint values make of the base's pose in the frame that it is attached to.
  Pose Moved(std::span<const double> q) const {
    const mjModel* m = core().model();
    const std::vector<int>& joints = core().joint_ids();
    Pose moved;
    const int body = m->jnt_bodyid[joints.front()];
    for (int k = 0; k < m->body_jntnum[body]; ++k) {
      const int joint = m->body_jntadr[body] + k;
      const auto at = std::ranges::find(joints, joint);
      if (at == joints.end()) continue;
      const double by =
          q[static_cast<size_t>(at - joints.begin())] - m->qpos0[m->jnt_qposadr[joint]];
      const Eigen::Vector3d axis(m->jnt_axis + 3 * joint);
      if (m->jnt_type[joint] == mjJNT_HINGE) {
        const Pose pivot(Eigen::Vector3d(m->jnt_pos + 3 * joint));
        moved = moved * pivot * Pose::FromRotvec({0, 0, 0}, by * axis) * pivot.inverse();
      } else {
        moved = moved * Pose(Eigen::Vector3d(by * axis));
      }
    }
    return moved;
  }

  bool IsInRange(int joint, double q) const {
    const mjModel* m = core().model();
    const mjtNum* range = m->jnt_range + 2 * joint;
    return !m->jnt_limited[joint] || (q >= range[0] - kInPlane && q <= range[1] + kInPlane);
  }

  // Returns the same angle a whole number of turns away, within the range if it has one there.
  double NearestTurn(int joint, double angle, double near) const {
    const double nearest = near + std::remainder(angle - near, 2 * kPi);
    for (const int turns : {0, 1, -1}) {
      if (IsInRange(joint, nearest + 2 * kPi * turns)) return nearest + 2 * kPi * turns;
    }
    return angle;
  }

  void RequireInRange(int joint, const std::string& name, double q) const {
    if (IsInRange(joint, q)) return;
    const mjtNum* range = core().model()->jnt_range + 2 * joint;
    throw ArgumentError(fmt::format(
        "{}: for this pose joint '{}' would be at {:.4g}, outside its range [{:.4g}, {:.4g}]. "
        "Widen the range in the model, or put the robot nearer in the scene",
        core().place(), name, q, range[0], range[1]));
  }

  LeavesObject leaving_;
};

bool HasFreeJoint(const mjModel* m, const std::string& name) {
  const int body = FindId(m, mjOBJ_BODY, name);
  return body > 0 && m->body_jntnum[body] > 0 && m->jnt_type[m->body_jntadr[body]] == mjJNT_FREE;
}

// Returns the name of the held object, among those that the scene knows.
std::string ObjectHeldBy(const Scene& scene, const GripperGroup& gripper) {
  for (const ObjectRecord& object : scene.compiled()->objects()) {
    if (object.free_joint && gripper.is_grasping(object.root_body)) return "'" + object.name + "'";
  }
  return "something";
}

}  // namespace

std::unique_ptr<BaseGroup> MakeBaseGroup(const Scene& scene, const RobotRecord& robot,
                                         GroupNames names) {
  switch (robot.base.kind) {
    case BaseKind::kMocap:
    case BaseKind::kFree:
      return std::make_unique<MovableBody>(scene, std::move(names), robot.base.kind);
    case BaseKind::kDriven:
      return std::make_unique<DrivenBase>(scene, std::move(names), robot.base, robot.base_target(),
                                          robot.base_weld());
    case BaseKind::kPlanar:
      if (HasFreeJoint(scene.model(), robot.base_body))
        return std::make_unique<WheeledBase>(scene, std::move(names));
      return std::make_unique<PlanarBase>(scene, std::move(names));
    case BaseKind::kFixed:
      break;
  }
  return std::make_unique<FixedBase>(scene, std::move(names));
}

std::string HeldByRobot(const Scene& scene, const std::string& robot) {
  if (!scene.FindObserver("robot:" + robot)) return "";
  const Robot made = Robot::Of(scene, robot);
  for (const std::string& name : made.group_names()) {
    const auto* gripper = dynamic_cast<const GripperGroup*>(&made.group(name));
    if (gripper && gripper->is_grasping())
      return fmt::format("gripper '{}' holds {}", name, ObjectHeldBy(scene, *gripper));
  }
  return "";
}

void LeavesObject::Warn(const Scene& scene, const std::string& robot, const std::string& place,
                        BaseKind base, const Pose& from, const Pose& to) {
  if (warned_ || Displacement(from, to) <= kNowhere) return;
  const std::string held = HeldByRobot(scene, robot);
  if (held.empty()) return;
  warned_ = true;
  // Small steps in the contacts of a body with mass.
  const bool pushes = base == BaseKind::kFree || base == BaseKind::kFixed;
  const std::string give =
      base == BaseKind::kDriven ? "" : "give the robot `base: {kind: driven}` and ";
  LogWarn(
      fmt::format("{}: it is put elsewhere while {}, which stays behind{}: setting a pose carries "
                  "nothing. To carry it, {}set the base's target (reported once)",
                  place, held, pushes ? " unless the fingers push it along" : "", give));
}

}  // namespace robocell::internal
