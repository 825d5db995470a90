// GroupCore: the common part of all move groups: joints, actuators and frames of one group, found
// by name in the scene's present model, and reading and writing of mjData. Groups contain one and
// forward to it; it knows nothing of arms or grippers.
//
// Members mean the same as the functions of that name in move_group.h. Errors begin with place().
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>
#include <Eigen/Core>

#include "robocell/mujoco/couplings.h"
#include "robocell/robot/addresses.h"
#include "robocell/robot/move_group.h"
#include "robocell/scene/scene.h"

namespace robocell {

namespace internal {
struct DriveLengths;
}

// A body or site of the model.
struct FrameName {
  bool is_site = false;
  std::string name = {};  // full name
};

// The parts of a group, by full names.
struct GroupNames {
  std::string robot = {};  // name for messages; may be empty
  std::string group = {};
  std::vector<std::string> joints = {};
  std::vector<std::string> actuators = {};
  FrameName root = {}, leaf = {};
  FrameName robot_base = {};
  // If true, joints that follow its own (mujoco/couplings.h) move with them, and its actuators may
  // act through fixed tendons and on followers.
  bool couples = false;
};

// A control that its actuator's ctrlrange clips.
struct CutCtrl {
  size_t actuator = 0, joint = 0;  // indices of the group's actuator and joint
  double wanted = 0;
  Interval range = {};
};

class GroupCore {
 public:
  // A joint that follows one of the group.
  struct Follower {
    int joint = -1, qpos_address = -1, dof_address = -1;
    size_t leader = 0;  // index in the group
    JointPolynomial of_leader;
  };

  // Holds the scene by inner(). Throws NotFoundError if the scene lacks one of the names.
  GroupCore(const Scene& scene, GroupNames names);

  const GroupNames& names() const { return names_; }
  const Scene& scene() const { return scene_; }
  const mjModel* model() const { return scene_.model(); }
  mjData* data() const { return scene_.data(); }
  void RequireOpen() const {
    if (scene_.closed()) ThrowClosed();
  }
  // Looks the names up again if the scene was rebuilt. Every public function calls it.
  void Bind() const {
    RequireOpen();
    if (scene_.now().generation != generation_) Resolve();
  }

  int nq() const { return static_cast<int>(qpos_addresses_.size()); }
  int nv() const { return static_cast<int>(dof_addresses_.size()); }
  int nu() const { return static_cast<int>(ctrl_addresses_.size()); }
  const std::vector<int>& joint_ids() const { return joint_ids_; }
  const std::vector<int>& actuator_ids() const { return actuator_ids_; }
  const std::vector<Follower>& followers() const { return followers_; }
  const std::vector<int>& ctrl_addresses() const { return ctrl_addresses_.list(); }

  void GetJointPos(std::span<double> out) const;
  void GetJointVel(std::span<double> out) const;
  void GetJointTorque(std::span<double> out) const;
  void GetCtrl(std::span<double> out) const;
  void SetJointPos(std::span<const double> q) const;
  // Writes without updating: poses are computed on demand.
  void WriteJointPos(std::span<const double> q) const;
  void SetJointVel(std::span<const double> v) const;
  void SetCtrl(std::span<const double> ctrl) const;

  std::vector<Interval> joint_pos_limits() const;
  void GetJointPosLimits(std::span<Interval> out) const;
  std::vector<Interval> ctrl_limits() const;
  void NoopCtrl(std::span<double> out) const;
  void CtrlForJointPos(std::span<const double> q, std::span<double> ctrl) const;
  // Makes filtered and delayed servos begin as if their target had been `q` for long.
  void SettleLags(std::span<const double> q) const;
  // Returns true if an actuator acts on each joint alone, in their order, and no joint follows one.
  bool has_plain_drive() const { return !lengths_; }
  // Returns how the lengths of the actuators change with the joints; only without a plain drive.
  Eigen::MatrixXd DriveMatrix(std::span<const double> q) const;
  // Returns the first control, from the actuator `from` on, that CtrlForJointPos clipped when it
  // made `ctrl` for `q`. No allocation.
  std::optional<CutCtrl> FindCutCtrl(std::span<const double> q, std::span<const double> ctrl,
                                     size_t from) const;
  void Integrate(std::span<double> q, std::span<const double> v) const;

  Pose leaf_frame_to_world() const { return FramePose(leaf_); }
  Pose root_frame_to_world() const { return FramePose(root_); }
  Pose leaf_frame_to_robot() const { return FramePose(base_).inverse() * FramePose(leaf_); }
  void Jacobian(Eigen::Ref<Eigen::Matrix<double, 6, Eigen::Dynamic>> out) const;
  // Returns the world's gravity in the axes of the robot base frame, m/s^2. Brings poses up to date
  // only if joints carry the base.
  Eigen::Vector3d gravity_in_base() const;

  // Returns "robot 'left' / group 'arm'".
  std::string place() const;

 private:
  struct FrameId {
    bool is_site = false;
    int id = -1;
  };

  [[noreturn]] void ThrowClosed() const;
  void Resolve() const;
  void ResolveJoints(const std::string& where) const;
  void ResolveActuators(const std::string& where) const;
  void ResolveFollowers() const;
  void ResolveLengths() const;
  void NarrowToFollowers(std::span<Interval> limits) const;
  // Returns the length of an actuator; unset if it acts on something else than the joints.
  std::optional<double> LengthFor(size_t actuator, std::span<const double> q) const;
  FrameId Find(const FrameName& frame, const std::string& where) const;
  Pose FramePose(FrameId& frame) const;
  std::optional<double> RestingCtrlFor(size_t actuator, std::span<const double> q) const;
  void RequireSize(size_t got, int expected, const char* what) const {
    if (got != static_cast<size_t>(expected)) ThrowWrongSize(got, expected, what);
  }
  [[noreturn]] void ThrowWrongSize(size_t got, int expected, const char* what) const;
  void RequireFiniteValues(std::span<const double> values,
                           const std::vector<std::string>& element_names, const char* kind) const;

  // Members used by every tick, kept together.
  Scene scene_;
  mutable uint64_t generation_ = ~uint64_t{0};
  // One per number, in the order of joints and actuators.
  mutable Addresses qpos_addresses_, dof_addresses_, ctrl_addresses_;
  mutable std::vector<int> joint_ids_, actuator_ids_;
  mutable std::vector<int> driven_;  // per actuator: index of the position it drives, or -1
  mutable std::vector<Follower> followers_;
  mutable std::shared_ptr<const internal::DriveLengths> lengths_;  // null with a plain drive
  mutable std::vector<double> jacobian_;                           // 6 x model nv, scratch
  mutable FrameId root_, leaf_, base_;
  mutable bool base_is_carried_ = false;  // true if joints carry the base
  GroupNames names_;
};

}  // namespace robocell
