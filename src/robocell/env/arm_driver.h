// ArmDriver: one robot of an environment and its gripper: from its part of the action to commands,
// and from the state to its part of the observation. Private to env; the Env steps.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "robocell/env/arm_target.h"
#include "robocell/env/arm_watch.h"
#include "robocell/env/env_layout.h"
#include "robocell/env/finger_watch.h"
#include "robocell/env/target_lead.h"
#include "robocell/robot/robot.h"

namespace robocell {

// What is left of an arm's motion when a step ends.
struct ArmMotion {
  // The largest of any joint: distance to its target, rad or m, and speed, per second.
  // Speeds are means over the last two engine steps: servos at their force limit may chatter.
  double joint_error = 0, joint_speed = 0;
  // The TCP's distance to where the joint targets put it, m and rad, and its speed, m/s and rad/s.
  double position_error = 0, rotation_error = 0;
  double linear_speed = 0, angular_speed = 0;
  // By how much the target falls short of the pose that was commanded, m and rad: not zero when
  // the pose had no solution nearby and the arm went towards it in damped steps.
  double position_shortfall = 0, rotation_shortfall = 0;
  // By how much the target from which the action started was taken back, because it led the arm by
  // more than max_target_lead: the largest of any joint, rad or m, or of the pose, m and rad.
  double joint_taken_back = 0, position_taken_back = 0, rotation_taken_back = 0;
};

// How an arm and its gripper stand to where they were sent.
enum class ArmStatus {
  kMoving,
  kSettled,  // at rest, and some joint is farther from its target than its tolerance
  kArrived,  // near and at rest
};

class ArmDriver {
 public:
  // What it knows of the past: where arm and gripper were sent, what relative actions start from,
  // and how the gripper is watched, over windows of time.
  struct Memory {
    Pose sent, origin;
    std::vector<double> sent_joints, origin_joints;
    std::vector<double> commanded;  // joints that the arm's controller drives to
    double sent_opening = 1, commanded_opening = 1;
    FingerWatch::Memory fingers = {};
    // What was added to the target and the arm did not carry out yet, and where the arm was when
    // that was last seen.
    PendingMove pending = {};
    std::vector<double> pending_joints = {};
    Pose seen = {};
    std::vector<double> seen_joints = {};

    // All but fingers.window, whose length is the gripper's.
    std::vector<double> numbers() const;
    // Of an arm with as many joints; takes its numbers from the front of what is given.
    static Memory FromNumbers(size_t joints, std::span<const double>& numbers);
    static size_t CountOfNumbers(size_t joints) { return 3 * 7 + 5 * joints + 5 + 6; }
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
  void RequireAction(std::span<const double> action, const std::string& place) const;
  // Sends the command; false when its pose has no solution and no motion leads towards it: then the
  // arm keeps its target. A small step to a pose without a solution nearby, as beside a
  // singularity, goes there in damped steps as far as these get.
  bool Send(std::span<const double> action);
  // Looks at the arm after every engine step, at simulated `time`. No allocation.
  void Watch(double time);
  // How the arm stood to where it was sent when it was last watched. No allocation.
  ArmStatus Status(double time);
  ArmMotion motion() const;
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
  bool SendJoints(std::span<const double> command, RobotAction& commands);
  bool SendPose(std::span<const double> command, RobotAction& commands);
  // The last target `sent`, without what is pending and leads the arm by more than max_target_lead: a
  // blocked arm does not pile up targets behind what blocks it. What the arm lags behind as it
  // moves and sags under gravity does not count, so that ramps go all the way.
  // `move`: what the action asks for, from the last target on. GetPresentTargets comes first.
  Pose LastPose(const Pose& sent, const PendingMove& move, PendingMove& pending, Pose& seen) const;
  std::vector<double> LastJoints(std::span<const double> move, std::vector<double>& pending,
                                 std::vector<double>& seen) const;
  // The joints that the arm drives to, without what is pending of them and leads the arm by more
  // than joint_lead_: a link that is blocked holds joints back while the TCP gets along. Returns
  // whether that changed them.
  bool BoundJoints(std::vector<double>& joints, std::vector<double>& pending,
                   std::vector<double>& seen) const;
  // Writes the target under which the arm at `q` goes on moving at `v`. False where it is unknown.
  bool GetSteadyTarget(std::span<const double> q, std::span<const double> v,
                       std::span<double> out) const;
  // Reads the present joint positions into pos_, and the targets under which they stay into rest_
  // and go on into steady_; the positions where that is unknown. False when they are not finite.
  bool GetPresentTargets() const;
  bool IsHeldAwayByGravity();
  void WatchFromNow();
  // The TCP with the joints at `q`, in the shared base frame.
  Pose TcpAt(std::span<const double> q) const { return base_in_shared_ * robot_.FkFrame(q); }
  Pose NextPose(const Pose& last, const Pose& given) const;
  bool GripperIsStill(double time) { return fingers_->IsStill(time, memory_.sent_opening); }
  const GripperGroup* gripper() const { return gripper_ ? &gripper_->gripper() : nullptr; }

  ControlMode mode_;
  RelativeTo relative_to_;
  StepLimit limit_, lead_;
  std::vector<double> joint_lead_;  // rad or m; in Cartesian modes what joints may lead by
  bool binary_gripper_;
  Robot robot_;
  ArmWatch watch_;
  std::vector<double> still_;                                                     // zeros
  mutable std::vector<double> pos_, vel_, gravity_, resistance_, rest_, steady_;  // scratch
  std::optional<Robot> gripper_;  // the robot that has the gripper ...
  std::optional<FingerWatch> fingers_;
  RobotLayout layout_;
  std::vector<Interval> joint_limits_;
  std::vector<bool> turns_freely_;  // a joint without limits
  Pose base_in_shared_;

  Memory memory_;
  ArmMotion sent_;  // of the last Send: what is missing of the command, and what was taken back
  std::shared_ptr<Controller> controller_;  // of the arm, as the last Send found it
};

}  // namespace robocell
