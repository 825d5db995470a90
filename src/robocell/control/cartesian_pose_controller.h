// Cartesian pose through position servos: the leaf frame moves to its target on a straight line and
// along the shortest rotation, within the speed limits.
//
//   robot.SetController("arm", "cartesian_pose");
//   auto& cartesian = dynamic_cast<CartesianPoseController&>(robot.controller("arm"));
//   cartesian.SetPose(robot.FkFrame() * Pose(Eigen::Vector3d(0, 0, -0.1)));
//
// Differential inverse kinematics at control rate: a reference moves towards the target, and the
// joint targets follow it by damped least squares, within their limits; redundant joints move
// towards the posture. An unreachable target is approached as far as the joints allow. What the
// arm's `task_space` leaves out of the target does not count; arms with fewer than six degrees of
// freedom reach the position first. Poses are in the robot base frame. Compute does not allocate.
#pragma once

#include <memory>
#include <vector>

#include "robocell/control/pose_target.h"
#include "robocell/kinematics/transform.h"
#include "robocell/robot/arm_group.h"
#include "robocell/robot/joint_position_controller.h"

namespace robocell {

namespace internal {
class TaskSpace;
}

class CartesianPoseController : public Controller {
 public:
  static constexpr std::string_view kKind = "cartesian_pose";
  // Throws NotFoundError for an arm without a chain, ArgumentError for one without position servos.
  explicit CartesianPoseController(ArmGroup& arm);

  std::string_view kind() const override { return kKind; }
  void RequireOpen() const override { arm_.RequireOpen(); }
  const Scene* scene() const override { return arm_.scene(); }
  TargetKind target_kind() const override { return TargetKind::kPose; }
  int target_size() const override { return 7; }
  void SetTarget(std::span<const double> numbers) override;
  std::span<const double> target() const override { return target_; }
  std::span<const double> commanded_joint_pos() const override { return servos_.target(); }
  std::span<double> command_port() override { return target_; }
  void Reset() override;
  void ResetTo(std::span<const double> servos) override;
  void Compute(std::span<double> ctrl) override;

  void SetPose(const Pose& leaf_in_robot) { target_ = ToNumbers(leaf_in_robot); }
  Pose pose() const;

  // m/s and rad/s; above 0.
  double max_linear_speed() const { return max_linear_speed_; }
  double max_angular_speed() const { return max_angular_speed_; }
  void SetMaxSpeeds(double linear, double angular);
  // Posture of redundant joints, rad or m; by default the arm's positions at the start.
  std::span<const double> posture() const { return posture_; }
  void SetPosture(std::span<const double> q);

 private:
  void HoldServos();
  void MoveReference(double seconds);
  void FollowReference(double seconds);
  void HoldReferenceBack();

  ArmGroup& arm_;
  std::shared_ptr<const internal::TaskSpace> task_space_;
  JointPositionController servos_;
  PoseNumbers target_ = {};
  Transform reference_;
  std::vector<double> posture_;
  double max_linear_speed_ = 0.25, max_angular_speed_ = 1;
  double time_ = 0;  // time of the last Compute, s
};

}  // namespace robocell
