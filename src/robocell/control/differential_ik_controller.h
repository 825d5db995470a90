// Twists through position servos: the leaf frame moves with a twist until the next target, the
// joints within their limits and speeds.
//
//   robot.SetController("arm", "differential_ik");
//   auto& jog = dynamic_cast<DifferentialIkController&>(robot.controller("arm"));
//   jog.SetTwist({.linear = {0, 0, -0.05}});
//
// Each tick DifferentialIk computes joint velocities for the twist at the commanded joint
// positions, and these advance by the velocities. Near a singularity the leaf frame slows down; at
// a limit other joints take over. Redundant joints move towards the posture. The commanded
// positions do not wait for a blocked arm. No allocation in Compute.
#pragma once

#include <array>
#include <vector>

#include "robocell/kinematics/differential_ik.h"
#include "robocell/robot/arm_group.h"
#include "robocell/robot/joint_position_controller.h"

namespace robocell {

class DifferentialIkController : public Controller {
 public:
  static constexpr std::string_view kKind = "differential_ik";
  // Throws NotFoundError for an arm without a chain, ArgumentError for one without position servos.
  explicit DifferentialIkController(ArmGroup& arm);

  std::string_view kind() const override { return kKind; }
  void RequireOpen() const override { arm_.RequireOpen(); }
  const Scene* scene() const override { return arm_.scene(); }
  TargetKind target_kind() const override { return TargetKind::kTwist; }
  int target_size() const override { return 6; }
  // Linear then angular velocity of the TCP, m/s and rad/s, in the axes of frame().
  void SetTarget(std::span<const double> twist) override;
  std::span<const double> target() const override { return target_; }
  std::span<const double> commanded_joint_pos() const override { return servos_.target(); }
  std::span<double> command_port() override { return target_; }
  void Reset() override;
  void ResetTo(std::span<const double> servos) override;
  void Compute(std::span<double> ctrl) override;

  void SetTwist(const Twist& twist);
  Twist twist() const;
  // The axes of the twist: the robot base's by default; or the TCP's, or the world's.
  TwistFrame frame() const { return options_.frame; }
  void SetFrame(TwistFrame frame) { options_.frame = frame; }
  // Largest speed of each joint, rad/s or m/s, above 0; default pi.
  std::span<const double> max_speed() const { return options_.max_speed; }
  void SetMaxSpeed(std::span<const double> speed);
  // Posture of redundant joints, rad or m, by default the arm's positions at the start; and the
  // rate at which they approach it, 1/s, 0 for none.
  std::span<const double> posture() const { return options_.posture; }
  void SetPosture(std::span<const double> q);
  double posture_rate() const { return options_.posture_rate; }
  void SetPostureRate(double per_second);
  // Returns true if the leaf frame moved slower than its target twist in the last tick.
  bool slower() const { return slower_; }

 private:
  void HoldServos();

  ArmGroup& arm_;
  JointPositionController servos_;
  std::array<double, 6> target_{};
  DifferentialIkOptions options_;
  bool slower_ = false;
  double time_ = 0;  // time of the last Compute, s
};

}  // namespace robocell
