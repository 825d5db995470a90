// Twists through position servos: the leaf moves as it is told to until it is told otherwise, its
// joints within their limits and no faster than allowed.
//
//   robot.SetController("arm", "differential_ik");
//   auto& jog = dynamic_cast<DifferentialIkController&>(robot.controller("arm"));
//   jog.SetTwist({.linear = {0, 0, -0.05}});
//
// Each tick DifferentialIk turns the twist into joint velocities at the commanded joint positions,
// and these move on by them: near a singularity the leaf slows down, at a limit the other joints do
// what they can. Redundant joints go to the posture. The commanded positions do not wait for an arm
// that is held up. No allocation in Compute.
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
  // NotFoundError for an arm without a chain, ArgumentError for one without position servos.
  explicit DifferentialIkController(ArmGroup& arm);

  std::string_view kind() const override { return kKind; }
  void RequireOpen() const override { arm_.RequireOpen(); }
  const Scene* scene() const override { return arm_.scene(); }
  TargetKind target_kind() const override { return TargetKind::kTwist; }
  int target_size() const override { return 6; }
  // Linear then angular velocity of the leaf, m/s and rad/s, in the axes of frame().
  void SetTarget(std::span<const double> twist) override;
  std::span<const double> target() const override { return target_; }
  std::span<const double> commanded_joint_pos() const override { return servos_.target(); }
  std::span<double> command_port() override { return target_; }
  void Reset() override;
  void ResetTo(std::span<const double> servos) override;
  void Compute(std::span<double> ctrl) override;

  void SetTwist(const Twist& twist);
  Twist twist() const;
  // The robot base's axes, unless set; or the leaf's, or the world's.
  TwistFrame frame() const { return options_.frame; }
  void SetFrame(TwistFrame frame) { options_.frame = frame; }
  // Of each joint, rad/s or m/s, above 0; at first pi.
  std::span<const double> max_speed() const { return options_.max_speed; }
  void SetMaxSpeed(std::span<const double> speed);
  // Where redundant joints go, rad or m; at first where the arm is. And how fast, 1/s; 0 lets them
  // rest.
  std::span<const double> posture() const { return options_.posture; }
  void SetPosture(std::span<const double> q);
  double posture_rate() const { return options_.posture_rate; }
  void SetPostureRate(double per_second);
  // Of the last tick: the leaf could not do what it was told.
  bool slower() const { return slower_; }

 private:
  void HoldServos();

  ArmGroup& arm_;
  JointPositionController servos_;
  std::array<double, 6> target_{};
  DifferentialIkOptions options_;
  bool slower_ = false;
  double time_ = 0;  // of the last Compute
};

}  // namespace robocell
