// For the checks of models: the ranges of a robot's joints, and the positions that its servos can reach.
//
//   const JointRanges ranges(robot);
//   const int joint = ranges.Joint("elbow"), servo = ranges.ServoOf(arm, joint);
//   if (const auto span = ranges.ServoSpan(servo)) ... span->lower ...
#pragma once

#include <mujoco/mujoco.h>

#include <optional>
#include <string>

#include "robocell/scene/inspection/robot_inspection.h"

namespace robocell::internal {

struct Reach {
  double lower = 0, upper = 0;
  double width() const { return upper - lower; }
  // Returns "-1 to 2".
  std::string text() const;
};

// The ranges of one robot, by the names of its model. Units: rad or m.
class JointRanges {
 public:
  explicit JointRanges(const CompiledRobot& robot)
      : m_(robot.model), robot_(robot.robot), part_(robot.part) {}

  // Returns a hinge's or slide's id; -1 for other and unknown joints.
  int Joint(const std::string& name) const;
  bool IsHinge(int joint) const { return m_->jnt_type[joint] == mjJNT_HINGE; }
  Reach RangeOf(int joint) const;
  const char* Unit(int joint) const { return IsHinge(joint) ? "rad" : "m"; }

  // Returns the servo of an arm's joint: one of the actuators that the arm lists, if it lists any.
  // -1 if something else drives the joint.
  int ServoOf(const MoveGroupConfig& arm, int joint) const;
  // Returns the range to which a servo can send its joint; unset without limits and for -1.
  std::optional<Reach> ServoSpan(int servo) const;
  // Returns the control with which a servo rests at a joint's position.
  double Ctrl(int servo, double joint_pos) const;

  // Returns the name without the robot's prefix.
  std::string Name(mjtObj kind, int id) const;

 private:
  double JointPos(int actuator, double ctrl) const;
  bool Drives(int actuator, int joint) const;

  const mjModel* m_;
  const RobotRecord& robot_;
  const Part& part_;
};

}  // namespace robocell::internal
