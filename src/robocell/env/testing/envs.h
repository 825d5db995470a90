// For tests only: environments of small arms, and of the built-in robot.
#pragma once

#include <string>

#include "robocell/base/rng.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/spec/env_config.h"
#include "robocell/task/pick_task_config.h"
#include "robocell/testing/random_values.h"

namespace robocell {

// A folder with an arm of two joints, a gripper, a box and a camera's housing.
class TwoArmFolder {
 public:
  RobotConfig arm() const {
    RobotConfig config = ArmConfig(arm_);
    config.attachment_site = "flange";
    return config;
  }
  RobotConfig gripper() const {
    RobotConfig config{.name = "gripper", .model = gripper_};
    config.move_groups["gripper"] = {.kind = MoveGroupKind::kGripper,
                                     .joints = {"left_slide", "right_slide"},
                                     .actuators = {"grip"},
                                     .fingers = {{.name = "left_pad"}, {.name = "right_pad"}},
                                     .ctrl = GripperCtrl{.open = 255, .closed = 0}};
    return config;
  }
  const std::string& box() const { return box_; }
  const std::string& housing() const { return housing_; }

  EnvConfig Duo() const {
    EnvConfig config;
    for (const char* side : {"left", "right"}) {
      config.robots[side] = arm();
      config.grippers[side] = gripper();
    }
    config.robot_to_shared_base_frame["left"] = Pose(Eigen::Vector3d(0, 0.3, 0));
    config.robot_to_shared_base_frame["right"] = Pose(Eigen::Vector3d(0, -0.3, 0));
    return config;
  }
  EnvConfig RandomDuo(Rng& rng) const {
    EnvConfig config = Duo();
    config.root_frame_to_world = RandomPose(rng);
    config.shared_base_frame_to_root_frame = RandomPose(rng);
    for (const std::string& robot : config.robots.keys())
      config.robot_to_shared_base_frame[robot] = RandomPose(rng);
    return config;
  }

 private:
  ModelFolder folder_;
  std::string arm_ = folder_.Write("arm", kTwoJointArm);
  std::string gripper_ = folder_.Write("gripper", kTwoFingerGripper);
  // Its model has a pose, which is dropped.
  std::string box_ = folder_.Write("box", R"(<worldbody><body name="box" pos="9 9 9">
    <geom size="0.02 0.02 0.02" type="box"/></body></worldbody>)");
  std::string housing_ = folder_.Write("housing", R"(<worldbody><body name="shell" pos="9 9 9">
    <geom size="0.02 0.02 0.01" type="box"/><camera name="eye" pos="0 0 0.02"/></body></worldbody>)");
};

// One built-in robot, called `robot`, in the world's origin.
inline EnvConfig Rc7Env(ControlMode mode = ControlMode::kJoints,
                        RelativeTo relative_to = RelativeTo::kLastStep) {
  EnvConfig config{.control_mode = mode, .relative_to = relative_to};
  config.robots["robot"] = Rc7();
  config.robots["robot"].home_noise = {};
  return config;
}

// The built-in robot in front of a cube to be picked, with a floor on the rig, wherever the rig is.
inline EnvConfig Rc7WithCube(const Pose& root = Pose()) {
  EnvConfig config = Rc7Env(ControlMode::kCartesianTquat, RelativeTo::kNone);
  config.root_frame_to_world = root;
  config.add_floor = false;
  config.root_frame_objects["cube"] = {.offset = Pose(Eigen::Vector3d(0.45, 0, 0.02)),
                                       .shape = Shape::kBox,
                                       .size = Vec3{0.02, 0.02, 0.02},
                                       .mass = 0.05};
  config.root_frame_objects["ground"] = {.offset = Pose(Eigen::Vector3d(0, 0, -0.05)),
                                         .fixed = true,
                                         .shape = Shape::kBox,
                                         .size = Vec3{1, 1, 0.05},
                                         .mass = 1};
  config.task = PickTaskConfig{.object = "cube", .spread = {0.05, 0.1}};
  return config;
}

// The built-in robot in joint mode, with a wall beside it that it reaches by turning its first
// joint.
inline EnvConfig Rc7BesideAWall() {
  EnvConfig config = Rc7Env(ControlMode::kJoints, RelativeTo::kConfiguredOrigin);
  config.max_relative_movement = {3};
  config.world_frame_objects["wall"] = {.offset = Pose(Eigen::Vector3d(0.4, 0.3, 0.6)),
                                        .fixed = true,
                                        .shape = Shape::kBox,
                                        .size = Vec3{0.4, 0.02, 0.6},
                                        .mass = 1};
  return config;
}

// Two built-in robots, off-centre and tilted towards each other, on a tilted rig.
inline EnvConfig Rc7Duo(ControlMode mode, RelativeTo relative_to) {
  EnvConfig config = Rc7Env(mode, relative_to);
  config.robots = {{"left", config.robots.at("robot")}, {"right", config.robots.at("robot")}};
  config.add_floor = false;
  config.root_frame_to_world = Pose::FromRpy({1, -2, 0.5}, {0.2, -0.1, 2});
  config.shared_base_frame_to_root_frame = Pose::FromRpy({0, 0, 0.34}, {0, 0.1, 0.3});
  config.robot_to_shared_base_frame["left"] = Pose::FromRpy({0.02, 0.25, 0}, {-0.4, 0.1, 0.2});
  config.robot_to_shared_base_frame["right"] = Pose::FromRpy({0, -0.25, 0.01}, {0.5, 0, -0.3});
  return config;
}

}  // namespace robocell
