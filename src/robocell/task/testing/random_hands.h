// For tests only: robots with random parallel hands beside random objects.
#pragma once

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <string>
#include <vector>

#include "robocell/base/files.h"
#include "robocell/base/rng.h"
#include "robocell/math/pose.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/motion/gripper_shape.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"
#include "robocell/spec/yaml.h"
#include "robocell/testing/random_values.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {

// Writes the model and the configuration of an arm with one joint and a hand with two sliding fingers
// of random sizes. Its TCP has a random pose in the hand. Returns the path of the configuration.
inline std::string WriteRandomHand(Rng& rng, const TempDir& folder) {
  const double stroke = rng.Uniform(0.03, 0.06), length = rng.Uniform(0.02, 0.04);
  const double width = rng.Uniform(0.006, 0.012), thick = rng.Uniform(0.004, 0.008);
  const Quaternion q = RandomQuaternion(rng);
  const std::string model = fmt::format(
      R"(<mujoco><option integrator="implicitfast"/><worldbody><body name="base"><geom type="box" size=".03 .03 .03" mass="1"/>
      <body name="hand" pos="0 0 .2"><joint name="turn" axis="0 0 1" range="-2 2" damping="5"/>
        <geom type="box" size=".03 {0} .02" mass=".5"/>
        <site name="tcp" pos="0 0 {1}" quat="{2} {3} {4} {5}"/>
        <body name="left" pos="0 {6} .02"><joint name="left" type="slide" axis="0 -1 0" range="0 {7}" damping="20"/>
          <geom name="left_pad" type="box" size="{8} {9} {10}" pos="0 0 {10}" mass=".05" friction="1.2 .05 .001" condim="4"/></body>
        <body name="right" pos="0 -{6} .02"><joint name="right" type="slide" axis="0 1 0" range="0 {7}" damping="20"/>
          <geom name="right_pad" type="box" size="{8} {9} {10}" pos="0 0 {10}" mass=".05" friction="1.2 .05 .001" condim="4"/></body>
      </body></body></worldbody>
      <actuator><position name="turn" joint="turn" kp="500" ctrlrange="-2 2"/>
      <position name="left" joint="left" kp="600" forcerange="-30 30" ctrlrange="0 {7}"/>
      <position name="right" joint="right" kp="600" forcerange="-30 30" ctrlrange="0 {7}"/></actuator></mujoco>)",
      stroke + 2 * thick, 0.02 + 2 * length - 0.01, q[3], q[0], q[1], q[2], stroke + thick, stroke,
      width, thick, length);
  AtomicWrite(folder / "hand.xml", model);
  AtomicWrite(folder / "hand.yaml", R"(name: hand
model: hand.xml
root_body: base
move_groups:
  arm: {kind: arm, joints: turn, actuators: turn, leaf: {site: tcp}}
  gripper: {kind: gripper, joints: [left, right], actuators: [left, right], leaf: {site: tcp},
            fingers: [left_pad, right_pad]}
)");
  return (folder / "hand.yaml").string();
}

// Writes a hand with three fingers that slide towards its middle.
inline std::string WriteThreeFingers(Rng& rng, const TempDir& folder) {
  const double stroke = rng.Uniform(0.03, 0.05), length = rng.Uniform(0.02, 0.04);
  std::string fingers, actuators;
  for (int i = 0; i < 3; ++i) {
    const double turn = 1.5708 + 2.0944 * i;
    fingers += fmt::format(
        R"(<body name="finger{0}" euler="0 0 {1}"><joint name="finger{0}" type="slide" axis="-1 0 0" range="0 {2}" damping="20"/>
        <geom name="pad{0}" type="box" size=".004 .007 {3}" pos="{4} 0 {5}" mass=".05" friction="1.2 .05 .001" condim="4"/></body>)",
        i, turn, stroke, length, stroke + 0.006, 0.02 + length);
    actuators += fmt::format(
        R"(<position name="finger{0}" joint="finger{0}" kp="600" forcerange="-20 20" ctrlrange="0 {1}"/>)",
        i, stroke);
  }
  AtomicWrite(
      folder / "hand.xml",
      fmt::format(
          R"(<mujoco><compiler angle="radian"/><option integrator="implicitfast"/><worldbody><body name="base"><geom type="box" size=".03 .03 .03" mass="1"/>
      <body name="hand" pos="0 0 .2"><joint name="turn" axis="0 0 1" range="-2 2" damping="5"/>
        <geom type="cylinder" size="{} .02" mass=".5"/><site name="tcp" pos="0 0 {}"/>{}</body></body></worldbody>
      <actuator><position name="turn" joint="turn" kp="500" ctrlrange="-2 2"/>{}</actuator></mujoco>)",
          stroke + 0.02, 0.02 + 1.6 * length, fingers, actuators));
  AtomicWrite(folder / "hand.yaml", R"(name: hand
model: hand.xml
root_body: base
move_groups:
  arm: {kind: arm, joints: turn, actuators: turn, leaf: {site: tcp}}
  gripper: {kind: gripper, joints: [finger0, finger1, finger2], actuators: [finger0, finger1, finger2],
            leaf: {site: tcp}, fingers: [pad0, pad1, pad2]}
)");
  return (folder / "hand.yaml").string();
}

// Returns a box, cylinder or sphere "thing" of a random size that fits between such fingers.
inline SceneObject RandomPrimitive(Rng& rng) {
  const auto small = [&] { return rng.Uniform(0.008, 0.02); };
  SceneObject object{.name = "thing"};
  switch (rng.UniformInt(3)) {
    case 0:
      object.shape = Shape::kBox;
      object.size = Vec3{small(), small(), rng.Uniform(0.01, 0.06)};
      break;
    case 1:
      object.shape = Shape::kCylinder;
      object.size = Vec3{small(), rng.Uniform(0.01, 0.06), 0};
      break;
    default:
      object.shape = Shape::kSphere;
      object.size = Vec3{small(), 0, 0};
  }
  object.rgba = Vec4{0.5, 0.5, 0.5, 1};
  object.mass = 0.05;
  object.friction = Vec3{1.2, 0.05, 0.001};
  object.condim = Condim::kTorsional;
  object.pos = Vec3{0.6, 0, 0.3};
  return object;
}

// Builds the hand and the object in free space.
inline Scene HandBeside(const std::string& hand, const SceneObject& object,
                        const Pose& pose = Pose(Eigen::Vector3d(0.6, 0, 0.3))) {
  SceneSpec spec{.name = "hand",
                 .timestep = 0.002,
                 .gravity = {0, 0, 0},
                 .add_floor = false,
                 .add_skybox = false};
  RobotSpec robot;
  robot.name = "hand";
  robot.config = LoadYaml<RobotConfig>(hand);
  spec.robots.push_back(robot);
  spec.objects.push_back(object);
  Scene scene = Scene::Build(spec);
  scene.Reset();
  scene.SetBodyPose(scene.compiled()->object("thing").root_body, pose);
  return scene;
}

// Moves the object into the hand, opens the fingers by the joints of the gap, and returns the smallest
// distance of hand and object: the engine's own kinematics and distances.
inline double DistanceInHand(Scene scene, const Robot& robot, const std::string& body,
                             const Pose& tcp_in_body, double gap) {
  const mjModel* m = scene.model();
  const auto shape = GripperShape::Of(robot.config(), scene.spec().options, scene.timestep());
  std::vector<double> joints(shape->joint_names().size());
  shape->JointsAt(gap, joints);
  for (size_t i = 0; i < joints.size(); ++i) {
    const int j = FindId(m, mjOBJ_JOINT, robot.prefix() + shape->joint_names()[i]);
    scene.data()->qpos[m->jnt_qposadr[j]] = joints[i];
  }
  scene.Forward();
  scene.SetBodyPose(body, robot.tcp_in_world() * tcp_in_body.inverse());
  const std::vector<int> object = internal::CollisionGeomsOf(m, FindId(m, mjOBJ_BODY, body));
  const int last = m->jnt_bodyid[FindId(m, mjOBJ_JOINT, robot.joint_names().back())];
  double least = 1;
  for (const int own : robot.geom_ids()) {
    if (!internal::IsCollisionGeom(m, own) || !internal::IsInSubtree(m, m->geom_bodyid[own], last))
      continue;
    for (const int other : object)
      least = std::min(least, mj_geomDistance(m, scene.data(), own, other, 1, nullptr));
  }
  return least;
}

}  // namespace robocell
