// For tests only: the Menagerie's robots as specs.
#pragma once

#include <string>

#include "robocell/spec/robot_spec.h"
#include "robocell/spec/yaml.h"
#include "robocell/testing/menagerie.h"

namespace robocell {

// The robot file of the tutorial: edits, two cameras, a mocap base, a linkage gripper.
inline RobotConfig XArm7Config() {
  const std::string yaml = R"(
name: xarm7
model: MODEL
edits:
  - {body: link_base, pos: [0, 0, 0]}
  - {site: link_tcp, xyaxes: [-1, 0, 0, 0, -1, 0]}
  - {add_camera: exo_camera,   body: link_base, pos: [0.05, 0.3, 0.4], quat_wxyz: [0.353553, 0.146447, -0.353553, -0.853553], fovy: 71}
  - {add_camera: wrist_camera, body: xarm_gripper_base_link, pos: [-0.07, 0, 0], quat_wxyz: [0.061628, 0.704416, -0.704416, -0.061628], fovy: 52}
root_body: link_base
base: {kind: mocap, size: [0.25, 0.25, 0.25]}
move_groups:
  arm:     {kind: arm, joints: joint1..joint7, actuators: act1..act7, leaf: {site: link_tcp}}
  gripper: {kind: gripper, joints: [left_driver_joint, right_driver_joint], actuators: [gripper], leaf: {site: link_tcp},
            fingers: [left_finger_pad_2, right_finger_pad_2], ctrl: {open: 0, closed: 255}, distance: {closed: 0.004, open: 0.089}}
home: {arm: [0, 0, 0, 0, 0, 0, 0], gripper: [0, 0]}
control: {arm: joint_position, gripper: joint_position}
gravcomp: true
)";
  std::string text = yaml;
  text.replace(text.find("MODEL"), 5, MenagerieModel("ufactory_xarm7", "xarm7.xml"));
  return ParseYaml<RobotConfig>(text, "xarm7.yaml");
}

// Gen3 with the 2F-85 as an attachment with prefix g_.
inline RobotSpec Gen3With2F85(const std::string& prefix = "") {
  return {.path = MenagerieModel("kinova_gen3", "gen3.xml"),
          .prefix = prefix,
          .attachments = {{.mjcf_path = MenagerieModel("robotiq_2f85", "2f85.xml"),
                           .attach_to = Site("pinch_site"),
                           .prefix = "g_"}}};
}

// xArm7 without its own hand, with the 2F-85 at its flange.
inline RobotSpec XArm7With2F85(const std::string& prefix = "") {
  return {.path = MenagerieModel("ufactory_xarm7", "xarm7_nohand.xml"),
          .prefix = prefix,
          .attachments = {{.mjcf_path = MenagerieModel("robotiq_2f85", "2f85.xml"),
                           .attach_to = Site("attachment_site"),
                           .prefix = "g_"}}};
}

}  // namespace robocell
