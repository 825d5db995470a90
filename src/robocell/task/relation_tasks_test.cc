#include "robocell/task/relation_tasks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;

Scene SceneWithUnit(const std::string& kind) {
  SceneSpec spec = EmptyScene();
  spec.objects.push_back({.name = "unit", .mjcf_path = kind, .pos = Vec3{0, 0, 0}, .fixed = true});
  Scene scene = Scene::Build(spec);
  scene.Reset();
  return scene;
}

TEST(StackTask, PicksUpTheSecondCubeFirst) {
  StackTask task({.cubes = 3});
  SceneSpec spec = EmptyScene();
  Rng rng = Rng::Stream(0, "stack");
  task.Prepare(spec, rng);
  EXPECT_THAT(task.objects(), ElementsAre("blue_cube", "red_cube", "green_cube"));
  EXPECT_EQ(task.kind_of("red_cube"), "cube");
}

TEST(JointTask, DrawsEachOfTheJointsWithAHandleAndSaysWhich) {
  Scene scene = SceneWithUnit("chest");
  JointTask task(OpenTaskConfig{.object = "unit"});
  task.Begin(scene);
  Rng rng = Rng::Stream(0, "joints");
  std::vector<std::string> seen;
  for (int i = 0; i < 20; ++i) {
    EXPECT_FALSE(task.Arrange(scene, rng).has_value());
    seen.push_back(task.instruction());
    EXPECT_FALSE(task.Judge(scene).success);
  }
  EXPECT_THAT(seen, Contains("open the lower drawer"));
  EXPECT_THAT(seen, Contains("open the upper drawer"));
}

TEST(JointTask, StartsWithinItsRange) {
  Scene scene = SceneWithUnit("cupboard");
  JointTask task(CloseTaskConfig{.object = "unit", .start_opening = {0.5, 0.6}});
  task.Begin(scene);
  Rng rng = Rng::Stream(0, "joints");
  double observed = 0;
  for (int i = 0; i < 10; ++i) {
    EXPECT_FALSE(task.Arrange(scene, rng).has_value());
    task.Observe(scene, {&observed, 1});
    EXPECT_GE(observed, 0.5);
    EXPECT_LE(observed, 0.6);
  }
}

TEST(JointTask, NamesJointsThatItCannotUse) {
  const Scene panel = SceneWithUnit("button_panel");
  ExpectThrow<ArgumentError>([&] { JointTask(OpenTaskConfig{.object = "unit"}).Begin(panel); },
                             "no joint that can be open");
  ExpectThrow<NotFoundError>(
      [&] {
        JointTask(PressTaskConfig{.object = "unit", .joint = "red_buton_slide"}).Begin(panel);
      },
      "Did you mean 'red_button_slide'");
}

}  // namespace
}  // namespace robocell
