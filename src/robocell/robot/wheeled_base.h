// Private to robot. WheeledBase: a planar base (`base: {kind: planar}`) whose model has a free joint
// and wheels on one axle or on several parallel ones: a differential drive. Its joints in the
// robot's configuration are the wheels; its joint values are three: x and y of the base and its yaw
// in the world. All else, such as castors, rolls along.
//
// The base's frame is that of the root, lowered to the floor under the wheels.
//
// UnicycleController drives the base to commanded joint values: a reference, which moves as wheels
// can (on an arc, or turning on the spot), goes there within limits of speed and acceleration, and
// the wheels' speeds follow from it and from the error of the base (Kanayama, Kimura, Miyazaki and
// Noguchi 1990). Wheels may have velocity servos, motors or position servos, and tendons that mix
// them.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>
#include <Eigen/Core>

#include "robocell/robot/base_group.h"
#include "robocell/robot/controller.h"
#include "robocell/robot/joint_group.h"
#include "robocell/robot/planar_motion.h"
#include "robocell/spec/ctrl_mode.h"

namespace robocell::internal {

// The motion of a frame that drives along its x axis and turns.
struct DriveSpeed {
  double ahead = 0, turn = 0;  // m/s, rad/s
};

class WheeledBase : public JointGroupOf<BaseGroup>, public PlanarMotion {
 public:
  // `names.joints`: the wheels. Throws ArgumentError if these cannot drive the base.
  WheeledBase(const Scene& scene, GroupNames names);

  int nq() const override { return 3; }
  int nv() const override { return 3; }
  void GetJointPos(std::span<double> out) const override;
  void GetJointVel(std::span<double> out) const override;
  // Returns the force of the wheels in the world's x and y, N, and their torque about z, N m.
  void GetJointTorque(std::span<double> out) const override;
  void SetJointPos(std::span<const double> q) override;
  void SetJointVel(std::span<const double> v) override;
  std::vector<Interval> joint_pos_limits() const override;
  void GetJointPosLimits(std::span<Interval> out) const override;
  void CtrlForJointPos(std::span<const double> q, std::span<double> ctrl) const override;
  std::optional<CutCtrl> FindCutCtrl(std::span<const double>, std::span<const double>,
                                     size_t) const override {
    return std::nullopt;
  }
  void SettleLags(std::span<const double>) override {}
  void Integrate(std::span<double> q, std::span<const double> v) const override;
  void Jacobian(Eigen::Ref<Eigen::Matrix<double, 6, Eigen::Dynamic>> out) const override;

  Pose pose() const override;
  void SetPose(const Pose& pose) override;
  bool is_mobile() const override { return true; }

  std::vector<double> JointsAt(const Pose& base_in_world,
                               std::span<const double> near) const override;
  Pose drive_frame() const override;
  bool drives_sideways() const override { return false; }
  BaseSpeeds most_speeds() const override { return kMostSpeeds; }

  // Computes the controls that roll the wheels so that the drive frame moves like this.
  void CtrlForSpeed(const DriveSpeed& speed, double seconds, std::span<double> ctrl);
  // Forgets how far wheels with position servos have been rolled.
  void Hold() { rolled_to_.clear(); }
  double time() const;
  // Returns a number that changes when the base or the whole state is put somewhere.
  uint64_t puts() const { return puts_ + core().scene().times_put(""); }

  static constexpr BaseSpeeds kMostSpeeds = {.linear = 1, .angular = 2.5};

 private:
  struct Wheel {
    Eigen::Vector3d at;     // middle, in the root's frame
    Eigen::Vector3d ahead;  // where the root goes there when the wheel turns by its axis
    double radius;
  };
  void Bind() const;
  Wheel WheelOf(int joint) const;
  void FindDrive() const;

  mutable uint64_t generation_ = ~uint64_t{0};
  mutable int root_ = -1, root_dof_ = -1;  // the root's body, and the first of its six speeds
  mutable std::vector<Wheel> wheels_;
  mutable Pose drive_;                       // the drive frame, on the floor, in the root's frame
  mutable Pose base_;                        // the base's frame, in the root's frame
  mutable std::vector<CtrlMode> kinds_;      // of the actuators
  mutable Eigen::MatrixXd lengths_;          // of the actuators, by the wheels' angles
  mutable Eigen::MatrixXd forces_;           // of the actuators, by the wheels' torques
  mutable Eigen::VectorXd rates_, torques_;  // of the wheels, scratch
  std::vector<double> rolled_to_;            // lengths of position servos
  uint64_t puts_ = 0;
  LeavesObject leaving_;
};

// Throws ArgumentError for any other group.
std::unique_ptr<Controller> MakeUnicycleController(MoveGroup& group);

class UnicycleController : public Controller {
 public:
  static constexpr std::string_view kKind = "unicycle";
  explicit UnicycleController(WheeledBase& base);

  std::string_view kind() const override { return kKind; }
  void RequireOpen() const override { base_.RequireOpen(); }
  const Scene* scene() const override { return base_.scene(); }
  int target_size() const override { return 3; }
  void SetTarget(std::span<const double> target) override;
  std::span<const double> target() const override { return commanded_joint_pos(); }
  std::span<const double> commanded_joint_pos() const override;
  std::span<double> command_port() override { return target_; }
  void Reset() override;
  void Compute(std::span<double> ctrl) override;

 private:
  struct Place {
    double x, y, yaw;
  };
  Place DrivePlace(std::span<const double> q) const;
  // Takes the place of a base that was put somewhere as the target, until another one is set.
  void FollowOthers() const;
  void HoldHere() const;
  void Advance(const Place& target, double seconds);

  WheeledBase& base_;
  mutable std::array<double, 3> target_ = {};
  mutable Place reference_ = {};  // of the drive frame
  mutable DriveSpeed speed_;      // of the reference
  mutable bool is_far_ = false;   // it drives to the target's place first, and then turns
  double time_ = 0;
  mutable uint64_t puts_ = 0;
};

}  // namespace robocell::internal
