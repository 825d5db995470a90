// ArmDriver: one robot of an environment and its gripper: from its part of the action to commands,
// and from the state to its part of the observation. Private to env; the Env steps.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "robocell/env/arm_target.h"
#include "robocell/env/env_layout.h"
#include "robocell/robot/robot.h"

namespace robocell {

class ArmDriver {
 public:
  // What it knows of the past: where arm and gripper were sent, what relative actions start from,
  // and how the gripper is watched, over windows of time.
  struct Memory {
    Pose sent, origin;
    std::vector<double> sent_joints, origin_joints;
    std::vector<double> commanded;  // joints that the arm's controller drives to
    double sent_opening = 1, commanded_opening = 1;
    bool gripper_still = false;  // at the end of the last window
    double window_start = 0, window_opening = 0;

    std::vector<double> numbers() const;
    // Of an arm with as many joints; takes its numbers from the front of what is given.
    static Memory FromNumbers(size_t joints, std::span<const double>& numbers);
    static size_t CountOfNumbers(size_t joints) { return 2 * 7 + 3 * joints + 5; }
  };

  // `robot` is one of the configuration's, `layout` its part of the vectors.
  // ArgumentError when the arm's controller takes no joint positions.
  ArmDriver(const EnvConfig& config, Robot robot, RobotLayout layout);

  const RobotLayout& layout() const { return layout_; }
  const Robot& robot() const { return robot_; }
  // The robots that it moves: the arm, and its gripper when that is one of its own.
  std::vector<Robot> robots() const;

  // Takes what the scene's reset left for the last target and the origin.
  void Reset();
  // Relative actions are now relative to where the arm was last sent.
  void SetOriginToCurrent();
  // ArgumentError for numbers that are not finite and a quaternion without direction, in the words
  // of `place`. `action` is the whole vector, here and below.
  void Check(std::span<const double> action, const std::string& place) const;
  // Sends the command; false when its pose has no solution: then the arm keeps its target.
  bool Send(std::span<const double> action);
  // Whether arm and gripper are where they were sent, or can go no further. Asked at every control
  // tick.
  bool HasArrived(double time);
  // For going back to a state of the scene: what it knows with it, and knowing it again after the
  // scene's state was set.
  Memory memory() const;
  void Recall(const Memory& memory);
  // Into its parts of the whole vector. Poses in the shared base frame.
  void Observe(std::span<double> observation) const;

 private:
  // What a number of an action says of the gripper.
  double Opening(double value) const;
  void SendGripper(double value, RobotAction& own);
  Pose NextPose(std::span<const double> command) const;
  std::vector<double> NextJoints(std::span<const double> command) const;
  bool GripperIsStill(double time);
  const GripperGroup* gripper() const { return gripper_ ? &gripper_->gripper() : nullptr; }

  ControlMode mode_;
  RelativeTo relative_to_;
  StepLimit limit_;
  bool binary_gripper_;
  Robot robot_;
  std::vector<double> tolerances_;  // within which each joint has arrived, rad or m
  std::vector<double> pos_, vel_;   // read by HasArrived()
  std::optional<Robot> gripper_;    // the robot that has the gripper
  RobotLayout layout_;
  std::vector<Interval> joint_limits_;
  std::vector<bool> turns_freely_;  // a joint without limits
  Pose base_in_shared_;

  Memory memory_;
  std::shared_ptr<Controller> controller_;  // of the arm, as the last Send found it
};

}  // namespace robocell
