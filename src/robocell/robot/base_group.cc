#include "robocell/robot/base_group.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

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
    const Pose mount = this->pose() * Pose::FromRpy({q[0], q[1], 0}, {0, 0, q[2]}).inverse();
    const Pose wanted = mount.inverse() * pose;
    const Eigen::Vector3d& at = wanted.translation();
    const Eigen::Vector3d rpy = wanted.rpy();
    if (std::abs(at.z()) > kInPlane || std::hypot(rpy[0], rpy[1]) > kInPlane) {
      throw ArgumentError(
          fmt::format("{}: a planar base moves in its plane only; the pose is "
                      "{:.4g} m above it and tilted by {:.4g} rad",
                      core().place(), at.z(), std::hypot(rpy[0], rpy[1])));
    }
    leaving_.Warn(core().scene(), core().names().robot, place(), BaseKind::kPlanar, this->pose(),
                  pose);
    SetJointVel(std::array{0.0, 0.0, 0.0});
    SetJointPos(std::array{at.x(), at.y(), rpy[2]});
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
