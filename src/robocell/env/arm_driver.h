// ArmDriver: one robot of an environment and its gripper: turns its part of the action into
// commands, and the state into its part of the observation. Private to env; the Env steps.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "robocell/env/arm_target.h"
#include "robocell/env/arm_watch.h"
#include "robocell/env/env_layout.h"
#include "robocell/env/env_state.h"
#include "robocell/env/env_step.h"
#include "robocell/env/finger_watch.h"
#include "robocell/env/number_list.h"
#include "robocell/env/target_lead.h"
#include "robocell/robot/action.h"
#include "robocell/robot/beyond_limits.h"
#include "robocell/robot/robot.h"
#include "robocell/robot/task_space.h"

namespace robocell::internal {

// The state of an arm and its gripper relative to their targets.
enum class ArmStatus {
  kMoving,
  kSettled,  // at rest, and a joint is farther from its target than its tolerance, or the fingers
             // are at another opening and hold nothing
  kArrived,  // near and at rest
};

// Appends an arm's memory to the numbers of a state: how many joints, their numbers and the others,
// and those of the fingers.
void PutMemory(const ArmMemory& memory, std::vector<double>& out);
// Reads it. Throws ArgumentError for other numbers.
ArmMemory ReadArmMemory(NumberReader& reader);

class ArmDriver {
 public:
  // `robot` is one of the configuration's, `layout` its part of the vectors. Throws ArgumentError
  // if the arm's controller takes no joint positions.
  ArmDriver(const EnvConfig& config, Robot robot, RobotLayout layout);

  const RobotLayout& layout() const { return layout_; }
  const Robot& robot() const { return robot_; }
  // Returns the robots that it moves: the arm, and its gripper if that is a separate robot.
  std::vector<Robot> robots() const;

  // Takes the last target and the origin from the scene after a reset.
  void Reset();
  // Makes relative actions relative to the arm's present target.
  void SetOriginToCurrent();
  // Throws ArgumentError, whose text begins with `place`, for numbers that are not finite and for a
  // quaternion without direction. `action` is the whole vector, here and below.
  void RequireAction(std::span<const double> action, const std::string& place) const;
  // Sends the command. Returns false if its pose has no solution and no motion leads towards it;
  // the arm then keeps its target. A small step to a pose without a solution nearby, for example
  // beside a singularity, is made in damped steps as far as these get.
  bool Send(std::span<const double> action);
  // Takes the commands of the arm and its gripper out of `action` and sends them as they are: no
  // limit of actions applies. A part without a command keeps its target. Returns false if a pose
  // has no solution.
  bool SendOwn(Action& action);
  // Observes the arm after every engine step, at simulated `time`. No allocation.
  void Watch(double time);
  // Returns the arm's state relative to its target at the last Watch. No allocation.
  ArmStatus Status(double time);
  ArmMotion motion() const;
  // The memory that belongs to a state of the scene. To restore it, set the scene's state first.
  ArmMemory memory() const;
  void Recall(const ArmMemory& memory);
  // Writes its parts of the whole vector. Poses are in the shared base frame.
  void Observe(std::span<double> observation) const;

 private:
  // Returns the opening that a number of an action commands.
  double Opening(double value) const;
  void SendGripper(double opening, RobotAction& own);
  // Drives the arm to joints to the bit, also with a controller that adds steps to a sum.
  void DriveTo(std::span<const double> joints);
  // Returns the nearest values within the joints' limits, and logs the first that is not inside.
  std::vector<double> InsideLimits(std::span<const double> joints);
  bool SendJoints(std::span<const double> command, RobotAction& commands);
  bool SendPose(std::span<const double> command, RobotAction& commands);
  // Returns the last target `sent`, less the part of `pending` that leads the arm by more than
  // max_target_lead: a blocked arm does not accumulate targets behind the obstacle. The lag of a
  // moving arm and its sag under gravity do not count, so that ramps are completed. `move`: the
  // action's move from the last target. Call GetPresentTargets first.
  Pose LastPose(const Pose& sent, const PendingMove& move, PendingMove& pending, Pose& seen) const;
  std::vector<double> LastJoints(std::span<const double> move, std::vector<double>& pending,
                                 std::vector<double>& seen) const;
  // Takes the pending part of the joint targets back where it leads the arm by more than
  // joint_lead_: a blocked link holds joints back while the TCP still moves. Returns true if it
  // changed them.
  bool BoundJoints(std::vector<double>& joints, std::vector<double>& pending,
                   std::vector<double>& seen) const;
  // Writes the target under which the arm at `q` continues to move at `v`. Returns false where it
  // is unknown.
  bool GetSteadyTarget(std::span<const double> q, std::span<const double> v,
                       std::span<double> out) const;
  // Reads the present joint positions into pos_, and the targets under which they stay into rest_
  // and continue into steady_; the positions themselves where these targets are unknown. Returns
  // false if the positions are not finite.
  bool GetPresentTargets() const;
  bool IsHeldAwayByGravity();
  void WatchFromNow();
  // Returns the TCP with the joints at `q`, in the shared base frame.
  Pose TcpAt(std::span<const double> q) const { return base_in_shared() * robot_.FkFrame(q); }
  // Returns the pose of the robot's base in the shared base frame, also of one that joints move.
  Pose base_in_shared() const;
  Pose NextPose(const Pose& last, const Pose& given) const;
  const GripperGroup* gripper() const { return gripper_ ? &gripper_->gripper() : nullptr; }

  ControlMode mode_;
  RelativeTo relative_to_;
  StepLimit limit_, lead_;
  std::vector<double> joint_lead_;  // rad or m; the lead of joints in Cartesian modes
  bool binary_gripper_;
  Robot robot_;
  TaskSpace task_space_;
  ArmWatch watch_;
  std::vector<double> still_;                                                     // zeros
  mutable std::vector<double> pos_, vel_, gravity_, resistance_, rest_, steady_;  // scratch
  std::optional<Robot> gripper_;  // the robot of the gripper ...
  std::optional<FingerWatch> fingers_;
  RobotLayout layout_;
  std::vector<Interval> joint_limits_;
  std::vector<bool> turns_freely_;  // a joint without limits
  BeyondLimits beyond_;
  bool base_moves_;
  Pose fixed_base_;  // in the shared base frame, since the last reset; unless base_moves_

  ArmMemory memory_;
  ArmMotion sent_;                          // motion of the last Send: shortfall, taken-back target
  std::shared_ptr<Controller> controller_;  // the arm's controller at the last Send
};

}  // namespace robocell::internal
