// Private to diagnose: the ranges of a robot's joints, and where its servos can send them.
//
//   const JointRanges ranges(robot);
//   const int joint = ranges.Joint("elbow"), servo = ranges.ServoOf(arm, joint);
//   if (const auto span = ranges.ServoSpan(servo)) ... span->lower ...
#pragma once

#include <mujoco/mujoco.h>

#include <optional>
#include <string>

#include "robocell/scene/robot_inspection.h"

namespace robocell::internal {

struct Reach {
  double lower = 0, upper = 0;
  double width() const { return upper - lower; }
  // "-1 to 2"
  std::string text() const;
};

// Of one robot, by the names of its own model. Units: rad or m.
class JointRanges {
 public:
  explicit JointRanges(const CompiledRobot& robot)
      : m_(robot.model), robot_(robot.robot), part_(robot.part) {}

  // A hinge's or slide's id; -1 for others and for what is not there.
  int Joint(const std::string& name) const;
  bool IsHinge(int joint) const { return m_->jnt_type[joint] == mjJNT_HINGE; }
  Reach RangeOf(int joint) const;
  const char* Unit(int joint) const { return IsHinge(joint) ? "rad" : "m"; }

  // The servo of an arm's joint: one of the actuators that the arm lists, where it lists any. -1
  // when something else drives the joint.
  int ServoOf(const MoveGroupConfig& arm, int joint) const;
  // Where a servo can send its joint; unset without limits and for -1.
  std::optional<Reach> ServoSpan(int servo) const;
  // The control with which a servo rests at a joint's position.
  double Ctrl(int servo, double joint_pos) const;

  // Without the robot's prefix.
  std::string Name(mjtObj kind, int id) const;

 private:
  double JointPos(int actuator, double ctrl) const;
  bool Drives(int actuator, int joint) const;

  const mjModel* m_;
  const RobotRecord& robot_;
  const Part& part_;
};

}  // namespace robocell::internal
