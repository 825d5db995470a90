#include "robocell/robot/base_group.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <array>
#include <cmath>
#include <cstddef>

#include "robocell/base/error.h"
#include "robocell/base/log.h"
#include "robocell/math/rotation.h"
#include "robocell/robot/driven_base.h"
#include "robocell/robot/joint_group.h"
#include "robocell/robot/robot.h"

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

// Two slides (x, y) and a hinge about z in the frame that the base is attached to.
class PlanarBase : public JointGroupOf<BaseGroup> {
 public:
  PlanarBase(const Scene& scene, GroupNames names)
      : JointGroupOf(scene, std::move(names), MoveGroupKind::kBase) {
    if (nq() == 3) return;
    throw ArgumentError(
        fmt::format("{}: a planar base has the joints x, y and yaw, this one has {} joint values",
                    core().place(), nq()));
  }
  Pose pose() const override { return leaf_frame_to_world(); }
  void SetPose(const Pose& pose) override {
    std::array<double, 3> q;
    GetJointPos(q);
    const mjModel* m = core().model();
    std::array<double, 3> zero;  // the joint values of the model's own pose
    for (size_t i = 0; i < 3; ++i) zero[i] = m->qpos0[m->jnt_qposadr[core().joint_ids()[i]]];
    const Pose pivot(Eigen::Vector3d(m->jnt_pos + 3 * core().joint_ids()[2]));
    const Pose moved = Pose(Eigen::Vector3d(q[0] - zero[0], q[1] - zero[1], 0)) * pivot *
                       Pose::FromRpy({0, 0, 0}, {0, 0, q[2] - zero[2]}) * pivot.inverse();
    const Pose mount = this->pose() * moved.inverse();
    const Pose wanted = mount.inverse() * pose;
    const Eigen::Vector3d at = wanted * pivot.translation() - pivot.translation();
    const Eigen::Vector3d rpy = wanted.rpy();
    if (std::abs(at.z()) > kInPlane || std::hypot(rpy[0], rpy[1]) > kInPlane) {
      throw ArgumentError(
          fmt::format("{}: a planar base moves in its plane only; the pose is "
                      "{:.4g} m above it and tilted by {:.4g} rad",
                      core().place(), at.z(), std::hypot(rpy[0], rpy[1])));
    }
    const std::array wanted_q{at.x() + zero[0], at.y() + zero[1], rpy[2] + zero[2]};
    for (size_t i = 0; i < 3; ++i) {
      const int joint = core().joint_ids()[i];
      const mjtNum* range = m->jnt_range + 2 * joint;
      if (!m->jnt_limited[joint] ||
          (wanted_q[i] >= range[0] - kInPlane && wanted_q[i] <= range[1] + kInPlane))
        continue;
      throw ArgumentError(fmt::format(
          "{}: for this pose joint '{}' would be at {:.4g}, outside its range [{:.4g}, {:.4g}]. "
          "Widen the range in the model, or put the robot nearer in the scene",
          core().place(), joint_names()[i], wanted_q[i], range[0], range[1]));
    }
    leaving_.Warn(core().scene(), core().names().robot, place(), BaseKind::kPlanar, this->pose(),
                  pose);
    SetJointVel(std::array{0.0, 0.0, 0.0});
    SetJointPos(wanted_q);
  }
  bool is_mobile() const override { return true; }

 private:
  LeavesObject leaving_;
};

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
