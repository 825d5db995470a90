// The outcome of a step of an environment: why it ended, the task's verdict on it, what collided,
// and what the arms have left to do.
#pragma once

#include <string>
#include <vector>

#include "robocell/task/task.h"

namespace robocell {

// Reasons for the end of a step; the first that applies is reported.
// kStopped: the user closed the window of a viewer that stops the scene (viewer/viewer.h).
enum class EndReason { kDiverged, kCollision, kIkFailed, kArrived, kSettled, kTimeout, kStopped };
const char* ToString(EndReason reason);

// A contact of a robot.
struct Collision {
  std::string robot;        // name in the scene
  std::string body;         // the robot's body, full name
  std::string other_robot;  // "" if the other body belongs to no robot
  std::string other_body;
  bool operator==(const Collision&) const = default;
};
// Describes it for messages: "robot 'left' (robotleft_fr3_link5) touches table_top".
std::string Describe(const Collision& collision);

// The motion that an arm has left when a step ends.
struct ArmMotion {
  // The largest value of any joint: distance to its target, rad or m, and speed, per second. Speeds
  // are means over the last two engine steps: servos at their force limit may chatter.
  double joint_error = 0, joint_speed = 0;
  // The TCP's distance to where the joint targets put it, m and rad, and its speed, m/s and rad/s.
  double position_error = 0, rotation_error = 0;
  double linear_speed = 0, angular_speed = 0;
  // Distance between the target and the commanded pose, m and rad: not zero when the pose had no
  // solution nearby and the arm went towards it in damped steps.
  double position_shortfall = 0, rotation_shortfall = 0;
  // Distance by which the action's start target was taken back because it led the arm by more than
  // max_target_lead: the largest value of any joint, rad or m, or of the pose, m and rad.
  double joint_taken_back = 0, position_taken_back = 0, rotation_taken_back = 0;
};

// The verdict is the task's on the state after the step; zeros without a task, after a divergence
// and after a step that was stopped.
struct EnvStep : TaskVerdict {
  EndReason reason = EndReason::kTimeout;
  double time = 0;                          // simulated s since the reset
  std::string message = {};                 // description of a divergence, or of what stopped
  std::vector<std::string> ik_failed = {};  // names of robots
  std::vector<Collision> collisions = {};   // new contacts in this step
};

}  // namespace robocell
