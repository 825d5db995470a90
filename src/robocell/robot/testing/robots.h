// For tests only: real robots as configurations, and scenes with them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "robocell/robot/robot.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/spec/yaml.h"
#include "robocell/testing/menagerie.h"
#include "robocell/testing/source_dir.h"

namespace robocell {

inline constexpr CtrlMode kPosition = CtrlMode::kPosition, kVelocity = CtrlMode::kVelocity,
                          kTorque = CtrlMode::kTorque;

inline RobotConfig LoadShipped(const std::string& path) {
  return RobotConfig::Load(SourceDir() + "/" + path);
}

// The built-in robot: servos, two finger slides on one tendon, 0..100 percent.
inline RobotConfig Rc7() { return LoadShipped("models/robots/rc7/rc7.yaml"); }

// A linkage gripper, 0..255, open at 0.
inline RobotConfig XArm7() { return LoadShipped("examples/xarm7.yaml"); }

// An arm with the 2F-85 linkage gripper as its tool. It configures no control and distance.
inline RobotConfig Gen3WithTool() {
  return ParseYaml<RobotConfig>(R"(
name: gen3
model: menagerie:kinova_gen3/gen3.xml
attachments: [{mjcf_path: 'menagerie:robotiq_2f85/2f85.xml', attach_to: {site: pinch_site}, prefix: g_}]
root_body: base_link
base: {kind: mocap, size: [0.25, 0.25, 0.25]}
move_groups:
  arm: {kind: arm, joints: joint_1..joint_7, actuators: joint_1..joint_7, leaf: {site: g_pinch}}
  gripper: {kind: gripper, joints: [g_right_driver_joint, g_left_driver_joint],
            actuators: [g_fingers_actuator], fingers: [g_left_pad1, g_right_pad1]}
home: {arm: [0, 0.26179939, 3.14159265, -2.26892803, 0, 0.95993109, 1.57079633]}
gravcomp: true
)",
                                "gen3.yaml");
}

// Unnamed finger geoms, closed at 0. A fixed base.
inline RobotConfig Panda() {
  return ParseYaml<RobotConfig>(R"(
name: panda
model: menagerie:franka_emika_panda/panda.xml
edits: [{add_site: tcp, body: hand, pos: [0, 0, 0.1034]}]
root_body: link0
move_groups:
  arm: {kind: arm, joints: joint1..joint7, actuators: actuator1..actuator7, leaf: {site: tcp}}
  gripper: {kind: gripper, joints: [finger_joint1, finger_joint2], actuators: [actuator8],
            fingers: [{geom: {body: left_finger, index: 3}}, {geom: {body: right_finger, index: 3}}],
            ctrl: {open: 255, closed: 0}}
home: {arm: [0, 0, 0, -1.57079, 0, 1.57079, -0.7853], gripper: [0.04, 0.04]}
gravcomp: true
)",
                                "panda.yaml");
}

// An arm without a configuration.
inline RobotSpec Fr3() { return {.path = "menagerie:franka_fr3/fr3.xml"}; }

inline SceneSpec SceneWith(RobotSpec robot) {
  SceneSpec spec = EmptyScene();
  spec.robots.push_back(std::move(robot));
  return spec;
}

// A robot named like its configuration in a scene of its own.
inline Robot RobotAlone(const RobotConfig& config) {
  const Scene scene = Scene::Build(SceneWith({.name = config.name, .config = config}));
  return Robot::Of(scene, config.name);
}

// How to make each of the robots, for tests that hold for all.
struct RobotCase {
  std::string name;
  std::vector<std::string> menagerie;  // models needed
  RobotSpec (*spec)();
  Robot (*robot)(const Scene&, const std::string& name);
};

inline void PrintTo(const RobotCase& robot, std::ostream* out) { *out << robot.name; }

inline std::vector<RobotCase> AllRobots() {
  const auto of = [](const Scene& s, const std::string& name) { return Robot::Of(s, name); };
  return {{"rc7", {}, [] { return RobotSpec{.config = Rc7()}; }, of},
          {"xarm7", {"ufactory_xarm7"}, [] { return RobotSpec{.config = XArm7()}; }, of},
          {"gen3",
           {"kinova_gen3", "robotiq_2f85"},
           [] { return RobotSpec{.config = Gen3WithTool()}; },
           of},
          {"panda", {"franka_emika_panda"}, [] { return RobotSpec{.config = Panda()}; }, of},
          {"fr3", {"franka_fr3"}, &Fr3, [](const Scene& s, const std::string&) {
             const std::string prefix = s.compiled()->robots()[0].prefix;
             return Robot::FromScene(s, "base", "fr3_link7",
                                     {.prefix = prefix, .tool = {.tcp_site = "attachment_site"}});
           }}};
}

inline std::string CaseName(const ::testing::TestParamInfo<RobotCase>& info) {
  return info.param.name;
}

// Updates, commands and steps robots of one scene; returns the largest displacement of a TCP.
template <class Command>
double Drift(const std::vector<Robot*>& robots, int steps, const Command& command) {
  std::vector<Eigen::Vector3d> starts;
  for (const Robot* robot : robots) starts.push_back(robot->tcp_in_world().translation());
  double farthest = 0;
  for (int i = 0; i < steps; ++i) {
    for (Robot* robot : robots) {
      robot->Update();
      command(*robot);
    }
    EXPECT_TRUE(robots[0]->Step().ok());
    for (size_t k = 0; k < robots.size(); ++k) {
      const Eigen::Vector3d now = robots[k]->tcp_in_world().translation();
      farthest = std::max(farthest, (now - starts[k]).norm());
    }
  }
  return farthest;
}

inline double Drift(Robot& robot, int steps) {
  return Drift({&robot}, steps, [](Robot&) {});
}

// Skips without the Menagerie models that the robot needs.
#define REQUIRE_ROBOT(robot)                                                           \
  if (!(robot).menagerie.empty()) {                                                    \
    const std::string missing_robot = ::robocell::MissingMenagerie((robot).menagerie); \
    if (!missing_robot.empty()) SKIP_OR_FAIL(missing_robot);                           \
  }                                                                                    \
  static_assert(true)

}  // namespace robocell
