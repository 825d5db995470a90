// For tests only: a torso with an arm of two hinges and a hand of two slides on each side.
#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

#include "robocell/robot/testing/robots.h"

namespace robocell {

inline std::string TorsoModel() {
  std::string bodies, servos;
  for (const char* side : {"l", "r"}) {
    bodies += fmt::format(R"(<body name="{0}_upper" pos="0 {1} 0.5">
        <joint name="{0}1" axis="0 0 1"/><geom size="0.04"/>
        <body name="{0}_lower" pos="0.2 0 0">
          <joint name="{0}2" axis="0 1 0"/><geom size="0.03"/><site name="{0}_tcp" pos="0.22 0 0"/>
          <body name="{0}_f1" pos="0.2 0.03 0"><joint name="{0}_g1" class="finger" axis="0 -1 0"/>
            <geom name="{0}_p1" type="box" size="0.03 0.005 0.01" mass="0.05"/></body>
          <body name="{0}_f2" pos="0.2 -0.03 0"><joint name="{0}_g2" class="finger" axis="0 1 0"/>
            <geom name="{0}_p2" type="box" size="0.03 0.005 0.01" mass="0.05"/></body>
        </body></body>)",
                          side, side == std::string("l") ? 0.3 : -0.3);
    for (const char* joint : {"1", "2"})
      servos +=
          fmt::format(R"(<position name="{0}{1}" joint="{0}{1}" kp="300" kv="30"/>)", side, joint);
    for (const char* joint : {"_g1", "_g2"})
      servos += fmt::format(
          R"(<position name="{0}{1}" joint="{0}{1}" kp="200" kv="20" ctrlrange="0 0.02"/>)", side,
          joint);
  }
  return R"(<compiler angle="radian" autolimits="true"/>
    <default><joint range="-2 2" damping="1"/><geom mass="0.5"/>
      <default class="finger"><joint type="slide" range="0 0.02" damping="2"/></default></default>
    <worldbody><body name="torso"><geom type="box" size="0.05 0.05 0.2" pos="0 0 0.2"/>)" +
         bodies + "</body></worldbody><actuator>" + servos + "</actuator>";
}

// Has the arms l_arm and r_arm, and the hands of these sides, l_hand and r_hand, in this order.
inline RobotConfig Torso(ModelFolder& folder, const std::vector<std::string>& hands) {
  RobotConfig config{.name = "torso", .model = folder.Write("torso", TorsoModel())};
  config.gravcomp = true;
  for (const std::string side : {"l", "r"}) {
    config.move_groups[side + "_arm"] = {
        .kind = MoveGroupKind::kArm,
        .joints = {side + "1", side + "2"},
        .actuators = {side + "1", side + "2"},
        .leaf = ElementRef{.kind = ElementKind::kSite, .name = side + "_tcp"}};
  }
  for (const std::string& side : hands) {
    config.move_groups[side + "_hand"] = {
        .kind = MoveGroupKind::kGripper,
        .joints = {side + "_g1", side + "_g2"},
        .actuators = {side + "_g1", side + "_g2"},
        .fingers = {{.name = side + "_p1"}, {.name = side + "_p2"}}};
  }
  return config;
}

}  // namespace robocell
