// Move groups written in Python: a subclass of MoveGroup, GripperGroup or BaseGroup defines methods
// (get_joint_pos, set_ctrl, ...) that return or take arrays. Each call takes the GIL.
//
// Such a group consists of two C++ objects: the one inside the Python object (PyGroup), and the one
// that a robot keeps (KeptGroup), which releases the Python object when the interpreter ends. Both
// make the same calls.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/trampoline.h>

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "arrays.h"
#include "robocell/robot/move_group.h"

namespace robocell::python {

// Marks a group with a Python object behind it.
class WrittenInPython {
 public:
  virtual ~WrittenInPython() = default;
  // Returns null after it was released. Needs the GIL.
  virtual PyObject* python_object() const = 0;
  // Returns a reference; needs the GIL. Throws ClosedError after it was released.
  nb::object object() const;
};

// Calls to methods of a group; they take the GIL.
namespace group_call {
// Copies a method's result. Throws ArgumentError for any other shape: "MyGroup.get_joint_pos:
// expected 7 values, got 3", "MyGroup.get_jacobian: expected an array of shape (6, 7), got (7, 6)".
void Get(const WrittenInPython& group, const char* method, std::span<double> out);
void Set(const WrittenInPython& group, const char* method, std::span<const double> values);
int Count(const WrittenInPython& group, const char* method);
// Throws ArgumentError unless the number is finite.
double Number(const WrittenInPython& group, const char* method);
// Converts the result of a method with `count` rows of two.
std::vector<Interval> Intervals(const WrittenInPython& group, const char* method, int count);
Pose Frame(const WrittenInPython& group, const char* method);
std::string Text(const WrittenInPython& group, const char* method);
std::vector<std::string> Texts(const WrittenInPython& group, const char* method);
// Returns the result of get_kind, else `otherwise`.
MoveGroupKind Kind(const WrittenInPython& group, MoveGroupKind otherwise);
void CtrlForJointPos(const WrittenInPython& group, std::span<const double> q,
                     std::span<double> ctrl);
void Integrate(const WrittenInPython& group, std::span<double> q, std::span<const double> v);
void Jacobian(const WrittenInPython& group, Eigen::Ref<Eigen::Matrix<double, 6, Eigen::Dynamic>> j);
}  // namespace group_call

template <class Base, MoveGroupKind kDefaultKind>
class GroupCalls : public Base, public WrittenInPython {
 public:
  const std::string& name() const override { return name_ = group_call::Text(*this, "get_name"); }
  MoveGroupKind kind() const override { return group_call::Kind(*this, kDefaultKind); }
  int nq() const override { return group_call::Count(*this, "get_joint_pos"); }
  int nv() const override { return group_call::Count(*this, "get_joint_vel"); }
  int nu() const override { return group_call::Count(*this, "get_ctrl"); }
  const std::vector<std::string>& joint_names() const override {
    return joint_names_ = group_call::Texts(*this, "get_joint_names");
  }
  const std::vector<std::string>& actuator_names() const override {
    return actuator_names_ = group_call::Texts(*this, "get_actuator_names");
  }
  void GetJointPos(std::span<double> out) const override { Get("get_joint_pos", out); }
  void GetJointVel(std::span<double> out) const override { Get("get_joint_vel", out); }
  void GetJointTorque(std::span<double> out) const override { Get("get_joint_torque", out); }
  void GetCtrl(std::span<double> out) const override { Get("get_ctrl", out); }
  void SetJointPos(std::span<const double> q) override {
    group_call::Set(*this, "set_joint_pos", q);
  }
  void SetJointVel(std::span<const double> v) override {
    group_call::Set(*this, "set_joint_vel", v);
  }
  void SetCtrl(std::span<const double> ctrl) override { group_call::Set(*this, "set_ctrl", ctrl); }
  std::vector<Interval> joint_pos_limits() const override {
    return group_call::Intervals(*this, "get_joint_pos_limits", nq());
  }
  std::vector<Interval> ctrl_limits() const override {
    return group_call::Intervals(*this, "get_ctrl_limits", nu());
  }
  void NoopCtrl(std::span<double> out) const override { Get("get_noop_ctrl", out); }
  void CtrlForJointPos(std::span<const double> q, std::span<double> ctrl) const override {
    group_call::CtrlForJointPos(*this, q, ctrl);
  }
  void Integrate(std::span<double> q, std::span<const double> v) const override {
    group_call::Integrate(*this, q, v);
  }
  Pose leaf_frame_to_world() const override { return Frame("get_leaf_frame_to_world"); }
  Pose root_frame_to_world() const override { return Frame("get_root_frame_to_world"); }
  Pose leaf_frame_to_robot() const override { return Frame("get_leaf_frame_to_robot"); }
  void Jacobian(Eigen::Ref<Eigen::Matrix<double, 6, Eigen::Dynamic>> out) const override {
    group_call::Jacobian(*this, out);
  }

 protected:
  void Get(const char* method, std::span<double> out) const { group_call::Get(*this, method, out); }
  Pose Frame(const char* method) const { return group_call::Frame(*this, method); }

 private:
  // Keeps values that the C++ side returns by reference.
  mutable std::string name_;
  mutable std::vector<std::string> joint_names_, actuator_names_;
};

using MoveGroupCalls = GroupCalls<MoveGroup, MoveGroupKind::kGeneric>;

class GripperGroupCalls : public GroupCalls<GripperGroup, MoveGroupKind::kGripper> {
 public:
  double opening() const override { return group_call::Number(*this, "get_opening"); }
  void SetOpening(double opening) override;
  double ctrl_for_opening(double opening) const override;
  double inter_finger_dist() const override {
    return group_call::Number(*this, "get_inter_finger_dist");
  }
  Interval inter_finger_dist_range() const override;
  bool is_open() const override;
  bool is_grasping(const std::string& body) const override;
};

class BaseGroupCalls : public GroupCalls<BaseGroup, MoveGroupKind::kBase> {
 public:
  Pose pose() const override { return Frame("get_pose"); }
  void SetPose(const Pose& pose_in_world) override;
  bool is_mobile() const override;
};

// The group inside the Python object.
template <class Calls>
class PyGroup : public Calls {
 public:
  NB_TRAMPOLINE(Calls);
  PyObject* python_object() const override { return nb_trampoline.base().ptr(); }
};

using PyMoveGroup = PyGroup<MoveGroupCalls>;
using PyGripperGroup = PyGroup<GripperGroupCalls>;
using PyBaseGroup = PyGroup<BaseGroupCalls>;

// The group that a robot keeps. `object` is an instance of MoveGroup, written in Python or not.
// Raises TypeError for a subclass whose __init__ did not call that of its base.
std::shared_ptr<MoveGroup> KeepGroup(nb::object object);

}  // namespace robocell::python
