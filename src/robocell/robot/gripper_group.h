// ActuatedGripper: a gripper with two fingers or more, moved by actuators whose raw controls run
// from one value (open) to another (closed): parallel slides and linkages alike. The first of three
// and more fingers closes against the others.
//
// Values missing from the configuration are determined on first use. Fingers: the bodies of the
// group's joints, if these are two, or the gripping parts at the ends of their linkages. Control:
// the actuator's range, where open is the end at which the fingers are farther apart; each of
// several actuators has its own range and its own open end. Distance: measured (gripper_range.h).
//
// An opening is a share of the measured distance. Its control is interpolated between the open and
// the closed end. Fingers may meet long before their actuators are at the closed end: then it is
// interpolated between the open end and the control at which they meet, and openings below 0.05
// continue from there to the closed end, which squeezes. A configured `ctrl` is used as it is.
//
// A hand with named poses goes from its pose `open` to its closing pose in the same way, each
// actuator between its own two controls; these too are used as they are.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "robocell/robot/beyond_limits.h"
#include "robocell/robot/finger.h"
#include "robocell/robot/gripper_range.h"
#include "robocell/robot/joint_group.h"
#include "robocell/spec/robot_config.h"

namespace robocell::internal {

class ActuatedGripper : public JointGroupOf<GripperGroup> {
 public:
  // `names.robot` is a robot of the scene; `config` uses names without its prefix. Throws
  // ArgumentError without an actuator or if the fingers cannot be determined.
  ActuatedGripper(const Scene& scene, GroupNames names, MoveGroupConfig config);

  double opening() const override;
  void SetOpening(double opening) override;
  double ctrl_for_opening(double opening) const override;
  void CtrlForOpening(double opening, std::span<double> ctrl) const override;
  double inter_finger_dist() const override;
  Interval inter_finger_dist_range() const override;
  bool is_open() const override;
  bool is_grasping(const std::string& body = "") const override;
  std::vector<std::string> pose_names() const override { return config_.poses.keys(); }
  std::string closing_pose() const override { return closing_pose_; }
  void SetClosingPose(const std::string& name) override;

  // Returns the fingers in the present model, 0 or 1 in the order of the configuration, and the
  // lowest body that carries both.
  const Finger& finger(int index) const { return Parts().pair.fingers[index == 0 ? 0 : 1]; }
  int hand_body() const { return Parts().pair.hand; }

  // Opens and closes the gripper in a copy of the simulation, whatever distances the configuration
  // has. Throws ArgumentError if the fingers do not move or do not come to rest, or if the
  // configured open and closed are swapped.
  GripperRange Measure() const;
  // The values of its first joint there. The same errors.
  GripperJointRange MeasureJoint() const;
  // Returns advice for fingers that do not return from the first controls to the second.
  std::string WhyTheyStay(const std::array<std::vector<double>, 2>& ctrl, double distance) const;
  std::string WhyTheyJam(const std::array<std::vector<double>, 2>& ctrl) const;
  std::string WhyNoOpening() const;
  // Names servos whose kv is so large that they hardly move the fingers, with an edit; "" for none.
  std::string WhySluggish() const;
  // Returns what a measurement shows to be wrong with the fingers, each with the edit that helps.
  std::vector<std::string> Doubts(const GripperRange& range) const;

 private:
  const GripperParts& Parts() const;
  void ResolveFingers() const;
  // Throws ArgumentError about a field of its configuration, with its place in the robot's file.
  [[noreturn]] void Fail(const char* field, const std::string& message) const;
  // The same for fingers that do not come together.
  [[noreturn]] void FailToClose(const char* field, const std::string& message) const;
  SettledFingers Settled(const std::array<std::vector<double>, 2>& ctrl) const {
    return Settled(Parts().pair, ctrl);
  }
  SettledFingers Settled(const FingerPair& pair,
                         const std::array<std::vector<double>, 2>& ctrl) const;
  // Takes the controls of the pose `open` and of the closing pose.
  void UsePoses();
  bool has_own_ends() const { return !configured_.empty(); }
  // Returns true for a pose that was chosen later, which need not bring the fingers together.
  bool is_other_pose() const {
    return !config_.poses.empty() && closing_pose_ != config_.closing_pose_name();
  }
  // Returns the share of the way from closed (0) to open (1) that the controls command.
  double CommandedShare() const;
  // Returns the control ends of each actuator, before measuring shows whether all are swapped.
  std::vector<GripperCtrl> Ends() const;
  // Determines for several actuators which end of each opens the fingers farther, with the others
  // at home: those two of them whose distance it changes most. An actuator that moves no finger
  // follows the first that does.
  void Orient(std::vector<GripperCtrl>& ends) const;
  double CheckedOpening(double opening) const;
  // Returns how far the controls are from closed (0) to open (1) at an opening.
  double ShareFor(double opening) const;
  double MeetingShare(const std::vector<GripperCtrl>& ends, const GripperDistance& distance) const;
  // Measured once.
  const GripperRange& Measured() const;
  const std::vector<GripperCtrl>& CtrlEnds() const {
    if (has_own_ends()) return configured_;
    return Measured().ctrl;
  }
  const GripperDistance& Distances() const {
    return config_.distance && !is_other_pose() ? *config_.distance : Measured().distance;
  }
  bool IsGraspingAnything() const;

  MoveGroupConfig config_;
  std::vector<GripperCtrl> configured_;  // configured controls of each actuator, if any
  std::string closing_pose_;             // of a hand with poses
  mutable std::map<std::string, GripperRange> measured_;  // by closing pose
  mutable uint64_t generation_ = ~uint64_t{0};
  mutable GripperParts parts_;
  mutable std::vector<FingerPair> pairs_;  // the first finger and each other one
  BeyondLimits beyond_;
};

}  // namespace robocell::internal
