// For tests only: arms in which joints follow others or actuators act together.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <string>
#include <string_view>
#include <vector>

#include "robocell/mujoco/names.h"
#include "robocell/robot/testing/robots.h"

namespace robocell {

// A parallelogram: j3 follows j2, and both have servos.
inline constexpr const char* kParallelogramArm = R"(<mujoco model="par"><compiler angle="radian"/>
  <option integrator="implicitfast"/>
  <default><geom contype="0" conaffinity="0"/><joint damping="2" armature=".05"/></default>
  <worldbody><body name="base"><geom type="cylinder" size=".06 .05" mass="3"/>
  <body name="l1" pos="0 0 .1"><joint name="j1" axis="0 0 1" range="-2.8 2.8"/>
    <geom type="capsule" fromto="0 0 0 0 0 .12" size=".04" mass="2"/>
  <body name="l2" pos="0 0 .12"><joint name="j2" axis="0 1 0" range="-1.5 1.9"/>
    <geom type="capsule" fromto="0 0 0 0 0 .3" size=".03" mass="2"/>
  <body name="l3" pos="0 0 .3"><joint name="j3" axis="0 1 0" range="-1.7 1.2"/>
    <geom type="capsule" fromto="0 0 0 .1 0 .15" size=".03" mass="1"/>
  <body name="l4" pos=".1 0 .15"><joint name="j4" axis="1 0 0" range="-2.9 2.9"/>
    <geom type="capsule" fromto="0 0 0 .1 0 0" size=".02" mass=".6"/>
  <body name="l5" pos=".1 0 0"><joint name="j5" axis="0 1 0" range="-1.9 1.9"/>
    <geom type="capsule" fromto="0 0 0 .07 0 0" size=".02" mass=".4"/>
  <body name="l6" pos=".07 0 0"><joint name="j6" axis="1 0 0" range="-3 3"/>
    <geom type="capsule" fromto="0 0 0 .04 0 0" size=".02" mass=".2"/>
    <site name="flange" pos=".05 0 0"/>
  </body></body></body></body></body></body></body></worldbody>
  <actuator><position name="m1" joint="j1" kp="2000" kv="150"/>
    <position name="m2" joint="j2" kp="2000" kv="150"/><position name="m3" joint="j3" kp="1200" kv="90"/>
    <position name="m4" joint="j4" kp="400" kv="30"/><position name="m5" joint="j5" kp="300" kv="20"/>
    <position name="m6" joint="j6" kp="200" kv="10"/></actuator>
  <equality><joint joint1="j3" joint2="j2" polycoef="0 -1 0 0 0"/></equality></mujoco>)";

// A telescope of three stages on one tendon, on a lift, with a wrist.
inline constexpr const char* kTelescopeArm = R"(<mujoco model="tele"><compiler angle="radian"/>
  <option integrator="implicitfast"/>
  <default><geom contype="0" conaffinity="0"/><joint damping="5" armature=".1"/></default>
  <worldbody><body name="base"><geom type="box" size=".15 .15 .05" mass="9"/>
  <body name="lift" pos="0 0 .3"><joint name="lift" type="slide" axis="0 0 1" range="0 .9"/>
    <geom type="box" size=".05 .05 .05" mass="1"/>
  <body name="s1"><joint name="s1" type="slide" axis="1 0 0" range="0 .12"/>
    <geom type="capsule" fromto="0 0 0 .2 0 0" size=".02" mass=".3"/>
  <body name="s2" pos=".1 0 0"><joint name="s2" type="slide" axis="1 0 0" range="0 .12"/>
    <geom type="capsule" fromto="0 0 0 .2 0 0" size=".015" mass=".3"/>
  <body name="s3" pos=".1 0 0"><joint name="s3" type="slide" axis="1 0 0" range="0 .12"/>
    <geom type="capsule" fromto="0 0 0 .2 0 0" size=".01" mass=".3"/>
  <body name="wy" pos=".2 0 0"><joint name="wy" axis="0 0 1" range="-2 2"/>
    <geom type="capsule" fromto="0 0 0 .05 0 0" size=".02" mass=".2"/>
  <body name="wp" pos=".05 0 0"><joint name="wp" axis="0 1 0" range="-1.5 1.5"/>
    <geom type="capsule" fromto="0 0 0 .05 0 0" size=".02" mass=".2"/>
  <body name="wr" pos=".05 0 0"><joint name="wr" axis="1 0 0" range="-3 3"/>
    <geom type="box" size=".02 .03 .02" pos=".03 0 0" mass=".2"/><site name="tip" pos=".07 0 0"/>
  </body></body></body></body></body></body></body></body></worldbody>
  <tendon><fixed name="extend"><joint joint="s1" coef="1"/><joint joint="s2" coef="1"/>
    <joint joint="s3" coef="1"/></fixed></tendon>
  <equality><joint joint1="s2" joint2="s1"/><joint joint1="s3" joint2="s2"/></equality>
  <actuator><position name="lift" joint="lift" kp="6000" kv="500"/>
    <position name="out" tendon="extend" kp="1000" kv="100"/>
    <position name="wy" joint="wy" kp="50" kv="5"/><position name="wp" joint="wp" kp="50" kv="5"/>
    <position name="wr" joint="wr" kp="50" kv="5"/></actuator></mujoco>)";

// A differential wrist: two tendons move the sum and the difference of the last two joints.
inline constexpr const char* kDifferentialArm = R"(<mujoco model="diff"><compiler angle="radian"/>
  <option integrator="implicitfast"/>
  <default><geom contype="0" conaffinity="0"/><joint damping="2" armature=".05"/></default>
  <worldbody><body name="base"><geom type="cylinder" size=".06 .05" mass="3"/>
  <body name="l1" pos="0 0 .1"><joint name="j1" axis="0 0 1" range="-2.8 2.8"/>
    <geom type="capsule" fromto="0 0 0 0 0 .12" size=".04" mass="2"/>
  <body name="l2" pos="0 0 .12"><joint name="j2" axis="0 1 0" range="-1.9 1.9"/>
    <geom type="capsule" fromto="0 0 0 0 0 .3" size=".03" mass="2"/>
  <body name="l3" pos="0 0 .3"><joint name="j3" axis="0 1 0" range="-2.5 2.5"/>
    <geom type="capsule" fromto="0 0 0 0 0 .2" size=".03" mass="1"/>
  <body name="l4" pos="0 0 .2"><joint name="j4" axis="0 0 1" range="-2.9 2.9"/>
    <geom type="capsule" fromto="0 0 0 0 0 .1" size=".02" mass=".6"/>
  <body name="l5" pos="0 0 .1"><joint name="j5" axis="0 1 0" range="-1.9 1.9"/>
    <geom type="capsule" fromto="0 0 0 0 0 .07" size=".02" mass=".4"/>
  <body name="l6" pos="0 0 .07"><joint name="j6" axis="0 0 1" range="-3 3"/>
    <geom type="capsule" fromto="0 0 0 .02 0 .04" size=".02" mass=".2"/>
    <site name="flange" pos="0 0 .06"/>
  </body></body></body></body></body></body></body></worldbody>
  <tendon><fixed name="sum"><joint joint="j5" coef="1"/><joint joint="j6" coef=".5"/></fixed>
    <fixed name="difference"><joint joint="j5" coef="1"/><joint joint="j6" coef="-.5"/></fixed></tendon>
  <actuator><position name="m1" joint="j1" kp="1500" kv="150"/>
    <position name="m2" joint="j2" kp="1500" kv="150"/><position name="m3" joint="j3" kp="1500" kv="150"/>
    <position name="m4" joint="j4" kp="500" kv="50"/>
    <position name="da" tendon="sum" kp="300" kv="30" ctrlrange="-5 5"/>
    <position name="db" tendon="difference" kp="300" kv="30" ctrlrange="-5 5"/></actuator></mujoco>)";

// Makes robots of these models.
class CoupledArms : public ::testing::Test {
 protected:
  RobotConfig Config(std::string_view model, const std::string& arm) {
    model.remove_prefix(model.find('>') + 1);
    model.remove_suffix(std::string_view("</mujoco>").size());
    return ParseYaml<RobotConfig>(
        fmt::format("name: r\nmodel: {}\nroot_body: base\n"
                    "move_groups: {{arm: {{kind: arm, {}}}}}\ngravcomp: true\n",
                    folder.Write("arm", std::string(model)), arm),
        "arm.yaml");
  }
  Robot Make(const RobotConfig& config) { return RobotAlone(config); }
  Robot Parallelogram(const std::string& joints = "j1..j6") {
    return Make(Config(kParallelogramArm, "joints: " + joints + ", leaf: {site: flange}"));
  }
  Robot Telescope(const std::string& joints = "[lift, s1, wy, wp, wr]") {
    return Make(Config(kTelescopeArm, "joints: " + joints + ", leaf: {site: tip}"));
  }
  Robot Differential(const std::string& more = "actuators: [m1, m2, m3, m4, da, db], ") {
    return Make(Config(kDifferentialArm, more + "joints: j1..j6, leaf: {site: flange}"));
  }

  static double Position(const Robot& robot, const char* joint) {
    const mjModel* m = robot.scene().model();
    const int id = FindId(m, mjOBJ_JOINT, joint);
    return robot.scene().data()->qpos[m->jnt_qposadr[id]];
  }
  // Commands a configuration and returns the largest remaining error of a joint.
  static double Reach(Robot& robot, const std::vector<double>& q, double seconds = 3) {
    robot.SetJntPosCmd(q);
    Drift(robot, static_cast<int>(seconds / robot.scene().timestep()));
    robot.Update();
    double most = 0;
    for (size_t i = 0; i < q.size(); ++i)
      most = std::max(most, std::abs(robot.jnt_pos_msr()[i] - q[i]));
    return most;
  }

  ModelFolder folder;
};

}  // namespace robocell
