// JointGroupOf<Interface>: implements MoveGroup's functions on top of a GroupCore, for any
// interface derived from it. JointGroup is the plain kind: arms (one actuator per one-DoF joint)
// and generic groups.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "robocell/robot/group_core.h"
#include "robocell/robot/move_group.h"

namespace robocell {

// Interface of groups with limits, controls and the start of their servos; see GroupCore.
class ServoGroup {
 public:
  // Writes joint_pos_limits() without allocation.
  virtual void GetJointPosLimits(std::span<Interval> out) const = 0;
  virtual std::optional<CutCtrl> FindCutCtrl(std::span<const double> q,
                                             std::span<const double> ctrl, size_t from) const = 0;
  virtual void SettleLags(std::span<const double> q) = 0;

 protected:
  ~ServoGroup() = default;
};

template <class Interface>
class JointGroupOf : public Interface, public ServoGroup {
 public:
  JointGroupOf(const Scene& scene, GroupNames names, MoveGroupKind kind)
      : core_(scene, std::move(names)), kind_(kind) {}

  const std::string& name() const override { return core_.names().group; }
  std::string place() const override { return core_.place(); }
  void RequireOpen() const override { core_.RequireOpen(); }
  const Scene* scene() const override { return &core_.scene(); }
  MoveGroupKind kind() const override { return kind_; }
  int nq() const override { return core_.nq(); }
  int nv() const override { return core_.nv(); }
  int nu() const override { return core_.nu(); }
  const std::vector<std::string>& joint_names() const override { return core_.names().joints; }
  const std::vector<std::string>& actuator_names() const override {
    return core_.names().actuators;
  }
  void GetJointPos(std::span<double> out) const override { core_.GetJointPos(out); }
  void GetJointVel(std::span<double> out) const override { core_.GetJointVel(out); }
  void GetJointTorque(std::span<double> out) const override { core_.GetJointTorque(out); }
  void GetCtrl(std::span<double> out) const override { core_.GetCtrl(out); }
  void SetJointPos(std::span<const double> q) override { core_.SetJointPos(q); }
  void SetJointVel(std::span<const double> v) override { core_.SetJointVel(v); }
  void SetCtrl(std::span<const double> ctrl) override { core_.SetCtrl(ctrl); }
  std::vector<Interval> joint_pos_limits() const override { return core_.joint_pos_limits(); }
  void GetJointPosLimits(std::span<Interval> out) const override { core_.GetJointPosLimits(out); }
  std::vector<Interval> ctrl_limits() const override { return core_.ctrl_limits(); }
  void NoopCtrl(std::span<double> out) const override { core_.NoopCtrl(out); }
  void CtrlForJointPos(std::span<const double> q, std::span<double> ctrl) const override {
    core_.CtrlForJointPos(q, ctrl);
  }
  std::optional<CutCtrl> FindCutCtrl(std::span<const double> q, std::span<const double> ctrl,
                                     size_t from) const override {
    return core_.FindCutCtrl(q, ctrl, from);
  }
  void SettleLags(std::span<const double> q) override { core_.SettleLags(q); }
  void Integrate(std::span<double> q, std::span<const double> v) const override {
    core_.Integrate(q, v);
  }
  Pose leaf_frame_to_world() const override { return core_.leaf_frame_to_world(); }
  Pose root_frame_to_world() const override { return core_.root_frame_to_world(); }
  Pose leaf_frame_to_robot() const override { return core_.leaf_frame_to_robot(); }
  void Jacobian(Eigen::Ref<Eigen::Matrix<double, 6, Eigen::Dynamic>> out) const override {
    core_.Jacobian(out);
  }

 protected:
  const GroupCore& core() const { return core_; }

 private:
  GroupCore core_;
  MoveGroupKind kind_;
};

using JointGroup = JointGroupOf<MoveGroup>;

}  // namespace robocell
