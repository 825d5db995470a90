// For tests only: small specs and models to start from.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "robocell/spec/scene_spec.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {

inline SceneSpec EmptyScene() {
  return {.name = "test", .timestep = 0.002, .add_floor = true, .add_skybox = true};
}

inline SceneObject BoxObject(const std::string& name, const Vec3& pos) {
  return {.name = name,
          .shape = Shape::kBox,
          .size = Vec3{0.02, 0.02, 0.02},
          .rgba = Vec4{1, 0.5, 0, 1},
          .mass = 0.1,
          .friction = Vec3{0.8, 0.02, 0.001},
          .pos = pos};
}

// A folder with models written as text, removed at the end of the test.
class ModelFolder {
 public:
  // `inside` is the text between <mujoco> and </mujoco>. Returns the path.
  std::string Write(const std::string& name, const std::string& inside) {
    const std::filesystem::path file = folder_ / (name + ".xml");
    std::ofstream(file) << "<mujoco model=\"" << name << "\">" << inside << "</mujoco>";
    return file.string();
  }
  std::filesystem::path path() const { return folder_.path(); }

 private:
  TempDir folder_;
};

// An arm of two hinges with servos, a flange site and a home key.
inline const char* kTwoJointArm = R"(
  <compiler angle="radian" autolimits="true"/>
  <default><joint axis="0 1 0" range="-2 2"/><geom type="capsule" contype="0" conaffinity="0"/></default>
  <worldbody>
    <body name="base" pos="0.1 0.2 0.3">
      <geom size="0.05 0.05" type="cylinder"/>
      <body name="upper" pos="0 0 0.1">
        <joint name="shoulder"/><geom size="0.02" fromto="0 0 0 0 0 0.3"/>
        <body name="fore" pos="0 0 0.3">
          <joint name="elbow"/><geom size="0.02" fromto="0 0 0 0 0 0.2"/>
          <site name="flange" pos="0 0 0.2" euler="0 0.5 0"/>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator>
    <position name="servo1" joint="shoulder" kp="100" kv="10"/>
    <position name="servo2" joint="elbow" kp="50" kv="5"/>
  </actuator>
  <sensor><jointpos name="elbow_position" joint="elbow"/></sensor>
  <keyframe><key name="home" qpos="0.3 -0.4" ctrl="0.31 -0.41"/></keyframe>)";

// The same with a ball on the flange whose actuator comes first and has three inputs and three
// outputs: the servos' inputs and outputs are not at their ids.
inline std::string TwoJointArmWithABall() {
  std::string model = kTwoJointArm;
  const auto put_before = [&](const std::string& what, const std::string& place) {
    model.insert(model.find(place), what);
  };
  put_before(R"(<body name="ball" pos="0 0 0.2"><joint name="ball" type="ball" range="0 3"/>
    <geom size="0.01" fromto="0 0 0 0 0 0.01"/></body>)",
             "<site");
  put_before(R"(<orientation name="turn" joint="ball" kp="0.01"/>)", "<position");
  model.replace(model.find("0.3 -0.4"), 8, "0.3 -0.4 1 0 0 0");
  model.replace(model.find("0.31 -0.41"), 10, "0 0 0 0.31 -0.41");
  return model;
}

// A parallel gripper of two slides with one actuator, driven by a tendon.
inline const char* kTwoFingerGripper = R"(
  <compiler angle="radian" autolimits="true"/>
  <default><joint type="slide" range="0 0.04"/><geom size="0.01 0.005 0.02" type="box"/></default>
  <worldbody>
    <body name="palm" pos="0 0 0.01">
      <geom size="0.02 0.05 0.01" mass="0.1"/>
      <body name="left" pos="0 0 0.03"><joint name="left_slide" axis="0 1 0"/><geom name="left_pad" mass="0.02"/></body>
      <body name="right" pos="0 0 0.03"><joint name="right_slide" axis="0 -1 0"/><geom name="right_pad" mass="0.02"/></body>
      <site name="pinch" pos="0 0 0.05"/>
    </body>
  </worldbody>
  <tendon><fixed name="split"><joint joint="left_slide" coef="0.5"/><joint joint="right_slide" coef="0.5"/></fixed></tendon>
  <equality><joint joint1="left_slide" joint2="right_slide"/></equality>
  <actuator><general name="grip" tendon="split" ctrlrange="0 255" gainprm="0.1568627" biastype="affine" biasprm="0 -1000 -10"/></actuator>)";

// A configuration for kTwoJointArm written at `model`.
inline RobotConfig ArmConfig(const std::string& model) {
  RobotConfig config{.name = "arm", .model = model};
  config.move_groups["arm"] = {.kind = MoveGroupKind::kArm,
                               .joints = {"shoulder", "elbow"},
                               .actuators = {"servo1", "servo2"},
                               .leaf = ElementRef{.kind = ElementKind::kSite, .name = "flange"}};
  return config;
}

}  // namespace robocell
