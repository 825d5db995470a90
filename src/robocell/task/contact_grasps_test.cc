#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/task/grasp_generator.h"
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

}  // namespace
}  // namespace robocell
