// Move groups written in Python: a subclass of MoveGroup, GripperGroup or BaseGroup defines methods
// (get_joint_pos, set_ctrl, ...) that return or take arrays. Each call takes the GIL.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/trampoline.h>

#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "robocell/robot/move_group.h"

namespace robocell::python {

// Calls to methods of a group. `self` is the Python object; all but Method take the GIL.
namespace group_call {
// The bound method; an Error names the class that does not define it.
nb::object Method(nb::handle self, const char* name);
bool Has(nb::handle self, const char* name);
// Copies numbers; "MyGroup.get_joint_pos: expected 7 values, got 3".
void Copy(nb::handle self, const char* name, nb::handle numbers, std::span<double> out);
void Get(nb::handle self, const char* name, std::span<double> out);
void Set(nb::handle self, const char* name, std::span<const double> values);
int Count(nb::handle self, const char* name);
double Number(nb::handle self, const char* name);
std::vector<Interval> Intervals(nb::handle self, const char* name);
Pose Frame(nb::handle self, const char* name);
std::string Text(nb::handle self, const char* name);
std::vector<std::string> Texts(nb::handle self, const char* name);
// What get_kind says, else `otherwise`.
MoveGroupKind Kind(nb::handle self, MoveGroupKind otherwise);
void CtrlForJointPos(nb::handle self, std::span<const double> q, std::span<double> ctrl);
void Integrate(nb::handle self, std::span<double> q, std::span<const double> v);
void Jacobian(nb::handle self, Eigen::Ref<Eigen::Matrix<double, 6, Eigen::Dynamic>> out);
}  // namespace group_call

// How a group tells that a Python object is behind it.
class WrittenInPython {
 public:
  virtual ~WrittenInPython() = default;
  virtual nb::handle object() const = 0;
};

template <class Base, MoveGroupKind kDefaultKind>
class PyGroupOf : public Base, public WrittenInPython {
 public:
  NB_TRAMPOLINE(Base);

  nb::handle object() const override { return self(); }
  const std::string& name() const override { return name_ = group_call::Text(self(), "get_name"); }
  MoveGroupKind kind() const override { return group_call::Kind(self(), kDefaultKind); }
  int nq() const override { return group_call::Count(self(), "get_joint_pos"); }
  int nv() const override { return group_call::Count(self(), "get_joint_vel"); }
  int nu() const override { return group_call::Count(self(), "get_ctrl"); }
  const std::vector<std::string>& joint_names() const override {
    return joint_names_ = group_call::Texts(self(), "get_joint_names");
  }
  const std::vector<std::string>& actuator_names() const override {
    return actuator_names_ = group_call::Texts(self(), "get_actuator_names");
  }
  void GetJointPos(std::span<double> out) const override { Get("get_joint_pos", out); }
  void GetJointVel(std::span<double> out) const override { Get("get_joint_vel", out); }
  void GetJointTorque(std::span<double> out) const override { Get("get_joint_torque", out); }
  void GetCtrl(std::span<double> out) const override { Get("get_ctrl", out); }
  void SetJointPos(std::span<const double> q) override {
    group_call::Set(self(), "set_joint_pos", q);
  }
  void SetJointVel(std::span<const double> v) override {
    group_call::Set(self(), "set_joint_vel", v);
  }
  void SetCtrl(std::span<const double> ctrl) override { group_call::Set(self(), "set_ctrl", ctrl); }
  std::vector<Interval> joint_pos_limits() const override {
    return group_call::Intervals(self(), "get_joint_pos_limits");
  }
  std::vector<Interval> ctrl_limits() const override {
    return group_call::Intervals(self(), "get_ctrl_limits");
  }
  void NoopCtrl(std::span<double> out) const override { Get("get_noop_ctrl", out); }
  void CtrlForJointPos(std::span<const double> q, std::span<double> ctrl) const override {
    group_call::CtrlForJointPos(self(), q, ctrl);
  }
  void Integrate(std::span<double> q, std::span<const double> v) const override {
    group_call::Integrate(self(), q, v);
  }
  Pose leaf_frame_to_world() const override { return Frame("get_leaf_frame_to_world"); }
  Pose root_frame_to_world() const override { return Frame("get_root_frame_to_world"); }
  Pose leaf_frame_to_robot() const override { return Frame("get_leaf_frame_to_robot"); }
  void Jacobian(Eigen::Ref<Eigen::Matrix<double, 6, Eigen::Dynamic>> out) const override {
    group_call::Jacobian(self(), out);
  }

 protected:
  nb::handle self() const { return nb_trampoline.base(); }
  void Get(const char* method, std::span<double> out) const {
    group_call::Get(self(), method, out);
  }
  Pose Frame(const char* method) const { return group_call::Frame(self(), method); }

 private:
  // What the C++ side wants by reference is kept here.
  mutable std::string name_;
  mutable std::vector<std::string> joint_names_, actuator_names_;
};

using PyMoveGroup = PyGroupOf<MoveGroup, MoveGroupKind::kGeneric>;

class PyGripperGroup : public PyGroupOf<GripperGroup, MoveGroupKind::kGripper> {
 public:
  double opening() const override { return group_call::Number(self(), "get_opening"); }
  void SetOpening(double opening) override;
  double ctrl_for_opening(double opening) const override;
  double inter_finger_dist() const override {
    return group_call::Number(self(), "get_inter_finger_dist");
  }
  Interval inter_finger_dist_range() const override;
  bool is_open() const override;
  bool is_grasping(const std::string& body) const override;
};

class PyBaseGroup : public PyGroupOf<BaseGroup, MoveGroupKind::kBase> {
 public:
  Pose pose() const override { return Frame("get_pose"); }
  void SetPose(const Pose& pose_in_world) override;
  bool is_mobile() const override;
};

}  // namespace robocell::python
