// For tests only: an arm of two hinges with a gripper, written into files with known line numbers.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "robocell/base/files.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/scenes.h"

namespace robocell {

struct ModelText {
  std::string angle = "radian", hip = "-2 2", knee = "-2.5 2.5", hip_ctrl = "-2 2",
              knee_ctrl = "-2.5 2.5", finger = "", rest = "", servo = "knee", first = "";
};

class ArmWithHand : public ::testing::Test {
 protected:
  // Joint hip is in line 3, knee in line 5, their servos are in lines 11 and 12.
  std::string Model(const ModelText& m = {}) {
    AtomicWrite(model_, fmt::format(R"(<mujoco><compiler angle="{}"/><worldbody><body name="base">
<geom size="0.05"/><body name="upper" pos="0 0 0.1">
<joint name="hip" axis="0 1 0" range="{}"/>
<geom type="capsule" size="0.02" fromto="0 0 0 0 0 0.3"/><body name="fore" pos="0 0 0.3">
<joint name="knee" axis="0 1 0" range="{}"/><geom size="0.02" mass="0.5"/><site name="tip" pos="0 0 0.1"/>
<body name="left" pos="0 0.05 0.05"><joint name="l" type="slide" axis="0 1 0" range="-0.04 0"/>
<geom type="box" size="0.01 0.004 0.02" {}/></body>
<body name="right" pos="0 -0.05 0.05"><joint name="r" type="slide" axis="0 -1 0" range="-0.04 0"/>
<geom type="box" size="0.01 0.004 0.02"/></body></body></body></body></worldbody>
<equality><joint joint1="l" joint2="r"/></equality>{}<actuator>
<position name="s1" joint="hip" kp="100" kv="10" ctrlrange="{}"/>
<position name="s2" joint="{}" kp="100" kv="10" ctrlrange="{}"/>
<position name="grip" joint="l" kp="100" kv="10" ctrlrange="-0.04 0"/></actuator>{}</mujoco>)",
                                    m.angle, m.hip, m.knee, m.finger, m.first, m.hip_ctrl, m.servo,
                                    m.knee_ctrl, m.rest));
    return model_;
  }

  // `fields` begin in line 6.
  std::vector<std::string> Warnings(const ModelText& m, const std::string& fields = "") {
    Model(m);
    return Build(fields).compiled()->warnings();
  }
  Scene Build(const std::string& fields = "", const std::string& of_arm = "") {
    AtomicWrite(file_,
                "name: arm\nmodel: arm.xml\nmove_groups:\n"
                "  arm: {kind: arm, joints: [hip, knee], leaf: {site: tip}" +
                    of_arm + "}\n  hand: {kind: gripper, joints: [l, r], actuators: [grip]}\n" +
                    fields);
    SceneSpec spec = EmptyScene();
    spec.robots.push_back({.name = "arm", .config = RobotConfig::Load(file_), .prefix = "a/"});
    return Scene::Build(spec);
  }

  ModelFolder folder_;
  const std::string model_ = (folder_.path() / "arm.xml").string();
  const std::string file_ = (folder_.path() / "arm.yaml").string();
};

}  // namespace robocell
