// ArmLink: ties a robot of a scene to a real arm. The scene becomes its twin: each step of the scene
// sends what the robot's controller commands and puts the measured joints into the simulation. So
// programs, controllers, environments, recorders and viewers are the same for both.
//
//   Robot robot = Robot::Of(scene, "rc7");
//   ArmLink link(robot, std::make_shared<UdpArm>("127.0.0.1:7071"));   // without it: simulation
//   while (link.ok()) {
//     robot.jnt_pos_cmd()[0] += 0.001;
//     robot.Update();
//     scene.Step();                       // in real time; kStopped once the arm has stopped
//   }
//
// Commands pass a SafetyGate (safety_gate.h). A stop is final: the arm brakes and holds, and every
// step returns StepResult::kStopped with the reason, until another link is made. The end of the
// link, also by an exception, brakes and holds the arm; a program that is killed falls silent, and
// the arm's own watch-dog holds it.
//
// A reset of the scene moves no arm: the robot begins where it was measured. Objects are simulated,
// and the gripper follows the measured opening by its actuators. With `dry_run` nothing is sent:
// the scene shows the arm as someone else moves it.
//
// The arm needs a controller that commands joint positions: joint_position, cartesian_pose,
// relative_joint_position, differential_ik; or joint_torque, if the port takes forces. Another one
// stops the link. Torques are all of the joints' forces, with those against gravity. Errors: ArgumentError for an
// arm with other joints or an invalid option, IoError if nothing is measured in time, and those of
// the port. Threads: those of the scene; any thread may call Renew and Stop, which count from the
// next step.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>

#include "robocell/hardware/arm_port.h"
#include "robocell/hardware/safety_gate.h"
#include "robocell/robot/robot.h"

namespace robocell {

struct ArmLinkOptions {
  SafetyOptions safety = {};
  // Seconds between two commands, rounded up to whole steps of the scene.
  double period = 0.004;
  double timeout = 2;      // for the first measurement, s
  std::string group = {};  // the arm, for robots with several; "": the first
};

class ArmLink {
 public:
  ArmLink(Robot robot, std::shared_ptr<ArmPort> port, const ArmLinkOptions& options = {});
  ~ArmLink();
  ArmLink(ArmLink&&) noexcept;
  ArmLink& operator=(ArmLink&&) = delete;

  // Brakes and holds the arm, and unties the robot, which stays where it is. May be repeated.
  void Close();
  bool closed() const;

  // Returns true while steps move the arm or wait for the dead man's switch.
  bool ok() const;
  ArmState state() const;
  const std::string& reason() const;
  const SafetyCounts& counts() const;
  const ArmMeasurement& measured() const;
  const ArmCommand& command() const;  // the last one, sent or not
  const ArmLimits& limits() const;
  double period() const;
  const Robot& robot() const;
  ArmPort& port() const;

  // The dead man's switch is pressed: call it more often than `dead_man`.
  void Renew();
  // Brakes and holds, for good.
  void Stop(const std::string& reason);
  // Commands the joints and steps the scene until they are measured there. Returns false if that
  // takes longer than `timeout` seconds, or the arm stops. `each` is called after each step. Throws
  // ArgumentError for joint values that do not fit, or a controller that takes none.
  bool MoveTo(std::span<const double> q, double timeout, const std::function<void()>& each = {});

 private:
  class Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace robocell
