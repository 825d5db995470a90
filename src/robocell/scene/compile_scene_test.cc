// Tests laws of whole scenes: order does not matter, and building twice gives the same scene.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/assets/resolve.h"
#include "robocell/base/rng.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/scenes.h"

namespace robocell {
namespace {

using ::testing::Contains;
using ::testing::Not;

TEST(SceneLaws, TheOrderOfEntitiesDoesNotChangePhysics) {
  ModelFolder folder;
  const RobotConfig arm = ArmConfig(folder.Write("arm", kTwoJointArm));
  std::vector<RobotSpec> robots;
  std::vector<SceneObject> objects;
  for (int i = 0; i < 3; ++i) {
    const std::string number = std::to_string(i);
    robots.push_back({.config = arm, .prefix = "r" + number + "_", .pos = {0, 1.0 * i, 0}});
    objects.push_back(BoxObject("cube" + number, {1.0 + 0.3 * i, 0, 0.2}));
    objects.back().euler = {10.0 * i, 5, 0};
  }
  const auto end = [&](uint64_t seed) {
    Rng rng = Rng::Stream(seed, "order");
    rng.Shuffle(robots);
    rng.Shuffle(objects);
    SceneSpec spec = EmptyScene();
    for (const RobotSpec& robot : robots) spec.robots.push_back(robot);
    for (const SceneObject& object : objects) spec.objects.push_back(object);
    Scene scene = Scene::Build(spec);
    EXPECT_TRUE(scene.StepN(250).ok());
    std::vector<Pose> poses;
    for (const char* body : {"cube0", "cube1", "cube2", "r0_fore", "r1_fore", "r2_fore"})
      poses.push_back(scene.body_pose(body));
    return poses;
  };
  const std::vector<Pose> expected = end(0);
  for (uint64_t seed = 1; seed < 8; ++seed) {
    const std::vector<Pose> poses = end(seed);
    for (size_t i = 0; i < poses.size(); ++i)
      EXPECT_TRUE(poses[i].is_close(expected[i], 1e-7, 1e-8)) << poses[i] << expected[i];
  }
}

TEST(SceneLaws, ASceneBuiltTwiceIsTheSameToTheBit) {
  SceneSpec spec = EmptyScene();
  spec.robots.push_back({.config = RobotConfig::Load(assets::BuiltinRobotFile("rc7"))});
  spec.objects.push_back(
      {.name = "mug", .mjcf_path = "mug", .pos = Vec3{0.5, 0, 0.2}, .fixed = false});
  const auto end = [&] {
    Scene scene = Scene::Build(spec);
    scene.Reset({.seed = 2});
    EXPECT_TRUE(scene.StepN(300).ok());
    return scene.state();
  };
  const std::vector<double> first = end();
  EXPECT_EQ(first, end());
  EXPECT_TRUE(Scene::Build(EmptyScene()).StepN(10).ok());
  EXPECT_EQ(first, end());
}

TEST(SceneLaws, ASpecCanBeBuiltAgainWithOtherContents) {
  SceneSpec spec = EmptyScene();
  const RobotSpec robot{.config = RobotConfig::Load(assets::BuiltinRobotFile("rc7"))};
  spec.robots.push_back(robot);
  spec.objects.push_back(
      {.name = "mug", .mjcf_path = "mug", .pos = Vec3{0.5, 0, 0.2}, .fixed = true});
  const Scene whole = Scene::Build(spec);
  spec.robots.clear();
  const Scene objects_only = Scene::Build(spec);
  EXPECT_THAT(objects_only.body_names(), Contains("mug_mug"));
  EXPECT_THAT(objects_only.body_names(), Not(Contains("base_link")));
  EXPECT_EQ(objects_only.model()->nq, 0);
  spec.robots.push_back(robot);
  const Scene again = Scene::Build(spec);
  EXPECT_EQ(again.body_names(), whole.body_names());
  EXPECT_EQ(again.state(), whole.state());
}

}  // namespace
}  // namespace robocell
