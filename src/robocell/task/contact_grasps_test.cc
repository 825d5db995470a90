#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <Eigen/Core>

#include "robocell/scene/testing/scenes.h"
#include "robocell/task/grasp_generator.h"
#include "robocell/task/grasp_proof.h"
#include "robocell/testing/pick_scene.h"

namespace robocell {
namespace {

// The handle of the door is a bar in front of its panel.
TEST(ContactGrasps, HandlesHooksAndPushesOfACabinetAreFound) {
  SceneObject cabinet{.name = "target", .mjcf_path = "cabinet", .pos = Vec3{0.6, 0, 0}};
  const RunConfig run = ExampleRun("demo.yaml");
  SceneSpec spec{.name = "kitchen", .timestep = 0.002, .add_floor = true, .add_skybox = true};
  spec.objects.push_back(cabinet);
  spec.robots.push_back({.name = "rc7", .config = run.robot.config, .prefix = "robot_0/"});
  Scene scene = Scene::Build(spec);
  scene.Reset();
  const Robot robot = Robot::Of(scene, "rc7");
  EXPECT_THAT(HandleGeomsOf(scene, "target_door"),
              testing::UnorderedElementsAre("target_door_handle", "target_door_handle_low",
                                            "target_door_handle_high"));
  for (const char* body : {"target_door", "target_drawer"}) {
    const GraspSet handle =
        GenerateGrasps(robot, body, {.kinds = {GraspKind::kHandle}, .samples = 600, .most = 20});
    EXPECT_GE(handle.grasps.size(), 3u) << body;
    for (const Grasp& grasp : handle.grasps) {
      EXPECT_EQ(grasp.kind, GraspKind::kHandle);
      EXPECT_NEAR(grasp.width, 0.012, 0.002) << "the bar's thickness";
    }
    const GraspSet hooks =
        GenerateGrasps(robot, body, {.kinds = {GraspKind::kHook}, .samples = 600, .most = 10});
    EXPECT_FALSE(hooks.grasps.empty()) << body;
    const GraspSet pushes =
        GenerateGrasps(robot, body, {.kinds = {GraspKind::kPush}, .samples = 200, .most = 10});
    EXPECT_FALSE(pushes.grasps.empty()) << body;
  }
}

// A lift whose cup, of 2 cm radius, points down.
constexpr const char* kSuctionLift = R"(<worldbody><body name="mast" pos="0 0 1">
  <body name="cup"><joint name="lift" type="slide" axis="0 0 1" range="-.1 .1"/>
    <geom name="lip" type="cylinder" size=".02 .03" mass=".1"/>
    <site name="tip" pos="0 0 -.03" quat="0 1 0 0"/></body></body></worldbody>
  <actuator><position joint="lift" kp="2000" kv="100"/>
    <adhesion name="suck" body="cup" gain="40" ctrlrange="0 1"/></actuator>)";

// All faces of the box are larger than the cup.
TEST(ContactGrasps, CupsStickToFacesFromAllSidesAndHoldWhenShaken) {
  ModelFolder folder;
  SceneSpec spec = EmptyScene();
  RobotSpec robot_spec;
  robot_spec.name = "lifter";
  robot_spec.config = RobotConfig{
      .name = "lifter",
      .model = folder.Write("lifter", kSuctionLift),
      .move_groups = {
          {"arm",
           {.kind = MoveGroupKind::kArm, .joints = {"lift"}, .leaf = ElementRef{.name = "tip"}}},
          {"cup",
           {.kind = MoveGroupKind::kGripper,
            .actuators = {"suck"},
            .leaf = ElementRef{.name = "tip"}}}}};
  spec.robots.push_back(robot_spec);
  SceneObject box = BoxObject("box", {0.5, 0, 0.2});
  box.size = Vec3{0.04, 0.05, 0.03};
  spec.objects.push_back(box);
  Scene scene = Scene::Build(spec);
  scene.Reset();
  const Robot robot = Robot::Of(scene, "lifter");
  const GraspSet set = GenerateGrasps(robot, "box", {.samples = 400, .most = 40});
  ASSERT_GT(set.grasps.size(), 10u);
  std::set<int> faces;
  for (const Grasp& grasp : set.grasps) {
    EXPECT_EQ(grasp.kind, GraspKind::kSuction);
    Eigen::Index axis = 0;
    EXPECT_GT(grasp.approach.cwiseAbs().maxCoeff(&axis), 1 - 1e-9) << "along a normal";
    faces.insert(static_cast<int>(axis) * 2 + (grasp.approach[axis] > 0));
    const Eigen::Vector3d tip = grasp.tcp_in_body.translation();
    EXPECT_NEAR(std::abs(tip[axis]), (*box.size)[static_cast<size_t>(axis)] - 0.001, 1e-6)
        << "it presses a little";
  }
  EXPECT_EQ(faces.size(), 6u);
  GraspSet best = set;
  best.grasps.resize(3);
  for (const GraspProof& proof : ProveGrasps(robot, best)) EXPECT_TRUE(proof.held) << proof.failure;
}

}  // namespace
}  // namespace robocell
