// SimulatedArm: a robot of a scene as an ArmPort: the arm behind a UdpArmServer, and one to try
// programs for a real arm with. Its servos, limits and weight are those of the model.
//
//   auto arm = std::make_shared<SimulatedArm>(Robot::Of(scene, "rc7"));
//   UdpArmServer server(arm, "127.0.0.1:0");
//
// It takes forces if the robot has the control mode of torques, too (RobotSpec::control_modes).
//
// It moves by itself: in real time whenever it is called, or, without `real_time`, in WaitUntil; its
// clock is that of the scene. Without a command for `watchdog` it holds, as real arms do.
//
// The scene is the arm's own: nobody else steps it. Errors: ArgumentError for a robot whose arm is
// not driven by position servos, and those of Scene. Threads: those of the scene.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/hardware/arm_port.h"
#include "robocell/robot/robot.h"

namespace robocell {

struct SimulatedArmOptions {
  ArmLimits limits = {};  // narrower than the model's: 2 rad/s or m/s, 10 rad/s^2 or m/s^2
  bool real_time = true;
  double noise = 0;       // standard deviation of measured positions, rad or m
  double watchdog = 0.2;  // s
  uint64_t seed = 0;
};

// Returns the limits of a robot's arm as its model has them.
ArmLimits LimitsOf(const Robot& robot);

class SimulatedArm final : public ArmPort {
 public:
  explicit SimulatedArm(Robot robot, const SimulatedArmOptions& options = {});

  std::string name() const override;
  std::vector<std::string> joint_names() const override;
  ArmLimits limits() const override { return limits_; }
  bool Read(ArmMeasurement& out) override;
  void Send(const ArmCommand& command) override;
  void Hold() override;
  bool takes_forces() const override { return takes_forces_; }
  double now() const override;
  void WaitUntil(double time) override;
  const Robot& robot() const { return robot_; }

 private:
  // Moves the arm to a time of its clock.
  void Advance(double time);

  Robot robot_;
  Scene scene_;
  SimulatedArmOptions options_;
  ArmLimits limits_;
  Rng rng_;
  std::string gripper_;
  double began_ = 0;      // the computer's clock at time 0 of the scene
  double commanded_ = 0;  // time of the last command
  double read_ = -1;      // time of the last measurement
  bool holds_ = true;
  bool takes_forces_ = false;
};

}  // namespace robocell
