// For tests only: an arm of one hinge whose weak servo sags under gravity, alone or above a block.
#pragma once

#include <cmath>
#include <string>

#include "robocell/env/env.h"
#include "robocell/scene/testing/scenes.h"

namespace robocell {

inline constexpr double kOneHingeStiffness = 50;  // N m/rad

// The arm is level at 0 and turns down with positive angles; its tip is 0.5 m from the hinge.
// `joint` and `servo` add attributes of the joint and its servo.
inline EnvConfig OneHinge(ModelFolder& folder, const std::string& joint = "damping='2'",
                          bool gravcomp = false, const std::string& servo = "") {
  RobotConfig robot{.name = "arm",
                    .model = folder.Write("hinge", R"(
    <compiler angle="radian" autolimits="true"/>
    <worldbody><body name="base"><geom type="box" size="0.05 0.05 0.05"/>
      <body name="link" pos="0 0 0.5"><joint name="hip" axis="0 1 0" range="-2 2" )" +
                                                       joint +
                                                       R"(/>
        <geom type="capsule" size="0.02" fromto="0 0 0 0.5 0 0" mass="1"/>
        <site name="tip" pos="0.5 0 0"/></body></body></worldbody>
    <actuator><position name="hip" joint="hip" kp="50" kv="5" )" +
                                                       servo + "/></actuator>")};
  robot.gravcomp = gravcomp;
  robot.move_groups["arm"] = {.kind = MoveGroupKind::kArm,
                              .joints = {"hip"},
                              .actuators = {"hip"},
                              .leaf = ElementRef{.kind = ElementKind::kSite, .name = "tip"}};
  EnvConfig config;
  config.robots["robot"] = robot;
  config.control_mode = ControlMode::kJoints;
  return config;
}

// Returns the distance of its servo from its target where gravity and the servo balance, rad.
inline double SagOfOneHinge(const Env& env) {
  const double angle = env.scene().joint_pos("robotrobot_hip");
  return 9.81 * 0.25 * std::cos(angle) / kOneHingeStiffness;
}

// The same over a block that it reaches at about 0.15 rad.
inline EnvConfig OneHingeOnABlock(ModelFolder& folder) {
  EnvConfig config = OneHinge(folder);
  config.world_frame_objects["block"] = {.offset = Pose(Eigen::Vector3d(0.45, 0, 0.3)),
                                         .fixed = true,
                                         .shape = Shape::kBox,
                                         .size = Vec3{0.05, 0.2, 0.1},
                                         .mass = 1};
  config.sim.on_collision = OnCollision::kReport;
  return config;
}

}  // namespace robocell
