// For tests only: hands without an arm, on a base of any kind, and a cube to pick.
#pragma once

#include <string>

#include "robocell/robot/testing/robots.h"

namespace robocell {

// Two fingers that slide along y, 0.1 m below the root, with pads of 2 cm x 1 cm; each closes with
// up to 20 N. The hand points down.
inline constexpr const char* kTwoFingers = R"(
  <worldbody>
    <body name="palm">
      <geom type="box" size="0.03 0.06 0.02" mass="0.5"/>
      <site name="tcp" pos="0 0 -0.1" euler="180 0 0"/>
      <body name="left" pos="0 0.04 -0.06">
        <joint name="left_slide" type="slide" axis="0 -1 0" range="0 0.04" damping="5"/>
        <geom name="left_pad" type="box" size="0.012 0.005 0.05" mass="0.05" friction="1.5" condim="4"/>
      </body>
      <body name="right" pos="0 -0.04 -0.06">
        <joint name="right_slide" type="slide" axis="0 1 0" range="0 0.04" damping="5"/>
        <geom name="right_pad" type="box" size="0.012 0.005 0.05" mass="0.05" friction="1.5" condim="4"/>
      </body>
    </body>
  </worldbody>
  <actuator>
    <position name="left_servo" joint="left_slide" kp="800" ctrlrange="0 0.04" forcerange="-20 20"/>
    <position name="right_servo" joint="right_slide" kp="800" ctrlrange="0 0.04" forcerange="-20 20"/>
  </actuator>)";

inline RobotConfig TwoFingerHand(ModelFolder& folder, const BaseConfig& base) {
  return {.name = "hand",
          .model = folder.Write("hand", kTwoFingers),
          .base = base,
          .move_groups = {{"gripper",
                           {.kind = MoveGroupKind::kGripper,
                            .joints = {"left_slide", "right_slide"},
                            .actuators = {"left_servo", "right_servo"},
                            .leaf = ElementRef{.name = "tcp"},
                            .fingers = {{.name = "left_pad"}, {.name = "right_pad"}},
                            .ctrl = GripperCtrl{.open = 0, .closed = 0.04}}}}};
}

// The 2F-85 of the Menagerie. Its fingers point along z of its base.
inline RobotConfig Hand2f85(const BaseConfig& base) {
  RobotConfig config = ParseYaml<RobotConfig>(R"(
name: hand
model: menagerie:robotiq_2f85/2f85.xml
move_groups:
  gripper: {kind: gripper, joints: [right_driver_joint, left_driver_joint], actuators: [fingers_actuator],
            fingers: [left_pad1, right_pad1], leaf: {site: pinch}}
)",
                                              "hand.yaml");
  config.base = base;
  return config;
}

}  // namespace robocell
