// For tests only: one object on the table and a robot that stands in front of it.
#pragma once

#include <memory>
#include <string>

#include "robocell/expert/pick_planner.h"
#include "robocell/motion/planning_scene.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/scene.h"
#include "robocell/scenes/catalogue.h"
#include "robocell/spec/run_config.h"
#include "robocell/testing/source_dir.h"

namespace robocell {

inline std::unique_ptr<Expert> MakePickPlanner(const RunConfig& run, const EpisodeStart& start) {
  return std::make_unique<PickPlanner>(run, start);
}

inline RunConfig ExampleRun(const std::string& file) {
  return RunConfig::Load(SourceDir() + "/examples/" + file);
}

// Returns "target", an object of a kind of the catalogue, in the middle of the table, not settled.
inline SceneObject ObjectOnTheTable(const std::string& kind, double yaw = 0.3) {
  Rng rng = Rng::Stream(3, "object", kind);
  SceneObject object = MakeCatalogueObject(kind, "target", rng);
  object.pos = {0, 0, 0.4505 + ObjectSizes().Of(object).height};
  object.quat = Pose::FromRpy({0, 0, 0}, {0, 0, yaw}).quaternion();
  return object;
}

struct PickScene {
  RunConfig run;
  Scene scene;
  Robot robot;
  std::string target_body;

  std::shared_ptr<const GripperShape> shape() const {
    return GripperShape::Of(robot.config(), run.options, scene.timestep());
  }
  PlanningScene planning() const { return {scene, robot, target_body, shape()}; }
  JointVector home() const {
    const std::vector<double> q = robot.arm().joint_pos();
    return JointVector(std::span<const double>(q));
  }
};

// The robot's base stands `distance` in front of the object, 0.25 m below the table's top.
inline PickScene MakePickScene(SceneObject object, const std::string& run_file = "demo.yaml",
                               double distance = 0.42) {
  const RunConfig run = ExampleRun(run_file);
  SceneSpec spec{.name = "test",
                 .base = "tabletop",
                 .timestep = 0.002,
                 .add_floor = true,
                 .add_skybox = true,
                 .options = run.options};
  spec.objects.push_back(std::move(object));
  spec.robots.push_back({.name = run.robot.config.name,
                         .config = run.robot.config,
                         .prefix = "robot_0/",
                         .pos = {-distance, 0, 0.2},
                         .control_modes = run.robot.config.used_modes()});
  Scene scene = Scene::Build(spec);
  scene.Reset();
  EXPECT_TRUE(scene.StepN(200).ok());
  Robot robot = Robot::Of(scene, run.robot.config.name);
  return {run, scene, robot, scene.compiled()->object("target").root_body};
}

}  // namespace robocell
