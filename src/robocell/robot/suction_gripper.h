// SuctionGripper: a gripper without fingers, whose <adhesion> actuators make bodies stick to what
// they touch: suction cups, magnets, adhesive pads.
//
// An opening of 1 releases, 0 sticks with the full force; in between the force is a share. Nothing
// measures an opening, so that it is the commanded one. The distance between fingers is 0.
//
//   move_groups:
//     cup: {kind: gripper, actuators: [suck], leaf: {site: tip}}
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "robocell/robot/beyond_limits.h"
#include "robocell/robot/joint_group.h"
#include "robocell/spec/robot_config.h"

namespace robocell::internal {

class SuctionGripper : public JointGroupOf<GripperGroup> {
 public:
  // Returns true if all of these actuators (full names) are adhesion actuators of the model, and
  // there is one.
  static bool IsMadeOf(const mjModel* model, const std::vector<std::string>& actuators);

  // Throws ArgumentError if an actuator has no control range and `config` gives no `ctrl`, and for
  // named poses.
  SuctionGripper(const Scene& scene, GroupNames names, const MoveGroupConfig& config);

  double opening() const override;
  void SetOpening(double opening) override;
  double ctrl_for_opening(double opening) const override;
  void CtrlForOpening(double opening, std::span<double> ctrl) const override;
  double inter_finger_dist() const override { return 0; }
  Interval inter_finger_dist_range() const override { return {0, 0}; }
  bool is_open() const override;
  // Returns true if a cup pulls at `body` or parts of it, or at any movable body outside the robot.
  bool is_grasping(const std::string& body = "") const override;

  // Returns the bodies that stick, in the present model.
  const std::vector<int>& cups() const;

 private:
  double Checked(double opening) const;

  std::vector<GripperCtrl> ends_;  // of each actuator
  std::string base_body_;          // of the robot
  mutable std::vector<int> cups_;
  mutable uint64_t generation_ = ~uint64_t{0};
  BeyondLimits beyond_;
};

}  // namespace robocell::internal
