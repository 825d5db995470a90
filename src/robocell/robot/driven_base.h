// Private to robot. DrivenBase: a base that follows a commanded pose with limited speed, and
// carries the object in the robot's gripper, for a hand without an arm.
//
// The base is a free body, which a constraint of the engine welds to a mocap body without geoms
// (scene/robot_base.h makes both). Each tick moves the mocap body towards the target; the engine
// moves the base after it, so that contacts know its velocity and friction holds.
//
// The weld is a spring and damper: at constant speed the base would trail its mocap body. So the
// mocap body runs ahead by what the weld makes of the speed, and the base itself is at the
// commanded pose, within 1.5 mm on the way. A base that something blocks stops there, and continues
// to its target as soon as it can. Whoever moves the mocap body or the base otherwise
// (Scene::SetBodyPose, Scene::SetState, data.mocap_pos) puts the target there, at rest.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "robocell/robot/joint_group.h"
#include "robocell/robot/pose_ramp.h"
#include "robocell/spec/robot_config.h"

namespace robocell::internal {

class DrivenBase : public JointGroupOf<BaseGroup> {
 public:
  // x y z, then the quaternion xyzw, in the world.
  using Target = std::array<double, 7>;

  // `names.leaf` is the free body, `target_body` the mocap body, `weld` the constraint between
  // them. Throws NotFoundError if the scene lacks one of them.
  DrivenBase(const Scene& scene, GroupNames names, const BaseConfig& config,
             std::string target_body, std::string weld);

  Pose pose() const override { return leaf_frame_to_world(); }
  void SetPose(const Pose& pose) override;
  bool is_mobile() const override { return true; }
  bool is_driven() const override { return true; }
  Pose target() const override;
  void SetTarget(const Pose& pose_in_world) override;
  BaseSpeeds max_speeds() const override { return speeds_; }
  void SetMaxSpeeds(const BaseSpeeds& speeds) override;
  // Teleports like SetPose.
  void SetJointPos(std::span<const double> q) override;

  // Returns the target's numbers for the controller to write; Advance() checks them.
  std::span<double> target_numbers() const { return target_; }
  // Moves the mocap body for the time since the last call, at most kLongestTick or one engine step:
  // larger steps would make the base faster than allowed. No allocation.
  void Advance();
  // Sets the target to the pose of the base, at rest.
  void Hold() const;

  static constexpr double kLongestTick = 0.005;  // s

 private:
  void Bind() const;
  // Adopts changes of the mocap body by other code.
  void FollowOthers() const;
  void HoldAt(const Pose& pose) const;
  void WriteMocap(const Pose& pose) const;
  // Result of FindBlocked: the motions that contacts block.
  struct Blocked {
    bool translation = false, rotation = false;
  };
  Blocked FindBlocked(const Pose& goal, const BaseSpeeds& planned) const;
  void RequireTarget(const Pose& pose) const;  // throws ArgumentError for a pose at no valid place

  std::string target_body_, weld_;
  BaseSpeeds speeds_;
  mutable Target target_ = {};
  mutable PoseRamp ramp_;
  mutable std::array<double, 7> written_ = {};  // the mocap body's position and quaternion wxyz
  mutable double time_ = 0;                     // time of the last Advance()
  mutable uint64_t generation_ = ~uint64_t{0};
  mutable uint64_t puts_ = 0;  // moves of the mocap body that are known
  mutable int mocap_ = -1, equality_ = -1;
  mutable std::vector<uint8_t> moved_;  // root body -> 1 if it moves with the robot
};

}  // namespace robocell::internal
