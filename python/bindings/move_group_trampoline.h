// MoveGroup from Python: a subclass defines methods (get_joint_pos, set_ctrl, ...) that return or
// take arrays.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/trampoline.h>

#include <string>
#include <vector>

#include "robocell/robot/move_group.h"

namespace robocell::python {

class PyMoveGroup : public MoveGroup {
 public:
  NB_TRAMPOLINE(MoveGroup);

  const std::string& name() const override;
  MoveGroupKind kind() const override;
  int nq() const override;
  int nv() const override;
  int nu() const override;
  const std::vector<std::string>& joint_names() const override;
  const std::vector<std::string>& actuator_names() const override;
  void GetJointPos(std::span<double> out) const override { Get("get_joint_pos", out); }
  void GetJointVel(std::span<double> out) const override { Get("get_joint_vel", out); }
  void GetJointTorque(std::span<double> out) const override { Get("get_joint_torque", out); }
  void GetCtrl(std::span<double> out) const override { Get("get_ctrl", out); }
  void SetJointPos(std::span<const double> q) override { Set("set_joint_pos", q); }
  void SetJointVel(std::span<const double> v) override { Set("set_joint_vel", v); }
  void SetCtrl(std::span<const double> ctrl) override { Set("set_ctrl", ctrl); }
  std::vector<Interval> joint_pos_limits() const override {
    return Intervals("get_joint_pos_limits");
  }
  std::vector<Interval> ctrl_limits() const override { return Intervals("get_ctrl_limits"); }
  void NoopCtrl(std::span<double> out) const override { Get("get_noop_ctrl", out); }
  void CtrlForJointPos(std::span<const double> q, std::span<double> ctrl) const override;
  void Integrate(std::span<double> q, std::span<const double> v) const override;
  Pose leaf_frame_to_world() const override { return Frame("get_leaf_frame_to_world"); }
  Pose root_frame_to_world() const override { return Frame("get_root_frame_to_world"); }
  Pose leaf_frame_to_robot() const override { return Frame("get_leaf_frame_to_robot"); }
  void Jacobian(Eigen::Ref<Eigen::Matrix<double, 6, Eigen::Dynamic>> out) const override;

 private:
  nanobind::object Call(const char* method) const;
  void Get(const char* method, std::span<double> out) const;
  void Set(const char* method, std::span<const double> values);
  std::vector<Interval> Intervals(const char* method) const;
  Pose Frame(const char* method) const;

  // What the C++ side wants by reference is kept here.
  mutable std::string name_;
  mutable std::vector<std::string> joint_names_, actuator_names_;
};

}  // namespace robocell::python
