// RobotSpec: a robot in a scene: its model, name and pose.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "robocell/spec/robot_config.h"

namespace robocell {

struct RobotSpec {
  std::optional<std::string> name = {};
  std::string path = {};
  Maybe<RobotConfig> config = {};
  std::string prefix = {};
  std::string model_prefix = {};
  std::string part_of = {};
  Maybe<BaseConfig> base = {};
  std::optional<bool> reset_root_pose = {};
  AttachTarget attach_to = {};
  Vec3 pos = {};
  Vec3 euler = {};
  Vec4 quat = kIdentityQuat;
  List<AttachmentSpec> attachments = {};
  std::optional<std::vector<CtrlMode>> control_modes = {};

  static constexpr const char* kTypeName = "RobotSpec";
  template <class V>
  static void Fields(V&& v) {
    v("name", &RobotSpec::name,
      "Name in the scene. Unset: the prefix without its trailing _ or /, else robot, robot_1, ...");
    v("path", &RobotSpec::path,
      "Model file of a robot without a configuration; instead of `config`.");
    v("config", &RobotSpec::config, "The robot's configuration.");
    v("prefix", &RobotSpec::prefix, "Prefix of every name of the robot; unique in the scene.");
    v("model_prefix", &RobotSpec::model_prefix,
      "Prefix of the robot's names in its model file. Its configuration uses the names without "
      "it.");
    v("part_of", &RobotSpec::part_of,
      "An earlier robot whose model file contains this one too. This robot then stands where that "
      "model has it; its own model, edits, attachments and place are not used.");
    v("base", &RobotSpec::base, "Overrides the configuration's base.");
    v("reset_root_pose", &RobotSpec::reset_root_pose,
      "Drop the pose that the model file gives its root. Unset: the configuration decides.");
    v("attach_to", &RobotSpec::attach_to, "Frame of pos and euler or quat.");
    v("pos", &RobotSpec::pos, "Position in the parent, metres.");
    v("euler", &RobotSpec::euler, "Orientation in the parent, degrees, extrinsic xyz.");
    v("quat", &RobotSpec::quat, "Orientation in the parent, quaternion xyzw; instead of euler.");
    v("attachments", &RobotSpec::attachments,
      "Tools mounted in this scene, after the configuration's own.");
    v("control_modes", &RobotSpec::control_modes,
      "Control modes of its arms beside the actuators of the model: position, velocity, torque. "
      "Unset: position and torque.");
  }
  Pose pose() const { return PlacementPose(pos, euler, quat); }
  const BaseConfig& EffectiveBase() const;
  bool can_switch_to(CtrlMode mode) const;
  // Returns the label with the name, or with the prefix if there is no name.
  std::string Label() const { return LabelOf("robot", name.value_or(prefix)); }
  void Validate(Problems& problems) const;
};

}  // namespace robocell
