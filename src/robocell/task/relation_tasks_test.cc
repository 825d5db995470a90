#include "robocell/task/relation_tasks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/scenes/catalogue.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsSupersetOf;

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
  Scene scene = SceneWithUnit("drawer_unit");
  JointTask task(OpenTaskConfig{.object = "unit"});
  task.Begin(scene);
  Rng rng = Rng::Stream(0, "joints");
  std::vector<std::string> seen;
  for (int i = 0; i < 20; ++i) {
    EXPECT_FALSE(task.Arrange(scene, rng).has_value());
    seen.push_back(task.instruction());
    EXPECT_FALSE(task.Judge(scene).success);
  }
  EXPECT_THAT(seen, Contains("open the drawer 1"));
  EXPECT_THAT(seen, Contains("open the drawer 3"));
}

std::vector<std::string> InstructionsOf(const JointTask& of, const std::string& kind) {
  JointTask task = of;
  Scene scene = SceneWithUnit(kind);
  task.Begin(scene);
  Rng rng = Rng::Stream(0, "joints");
  std::set<std::string> seen;
  for (int i = 0; i < 30; ++i) {
    EXPECT_FALSE(task.Arrange(scene, rng).has_value());
    seen.insert(task.instruction());
  }
  return {seen.begin(), seen.end()};
}

// A dial turns on the spot: it is neither opened nor pressed unless it is named.
TEST(JointTask, OpensDoorsAndPressesButtonsButTurnsNoDials) {
  const JointTask open(OpenTaskConfig{.object = "unit"}), press(PressTaskConfig{.object = "unit"});
  EXPECT_THAT(InstructionsOf(open, "microwave"), ElementsAre("open the door"));
  EXPECT_THAT(InstructionsOf(open, "laptop"), ElementsAre("open the lid"));
  EXPECT_THAT(InstructionsOf(open, "faucet"), ElementsAre("open the lever"));
  EXPECT_THAT(InstructionsOf(open, "lid_box"), ElementsAre("open the lid"));
  EXPECT_THAT(InstructionsOf(press, "microwave"), ElementsAre("press the start button"));
  EXPECT_THAT(InstructionsOf(press, "button_panel"),
              ElementsAre("press the blue button", "press the green button", "press the red button",
                          "press the yellow button"));
}

TEST(PlaceNextToTask, DrawsWhatTasksDrawUnlessItNamesKindsOrCategories) {
  SceneSpec spec = EmptyScene();
  const auto drawn = [&](const PlaceNextToTaskConfig& fields) {
    PlaceNextToTask task(fields);
    std::set<std::string> kinds;
    for (uint64_t seed = 0; seed < 40; ++seed) {
      SceneSpec with = spec;
      Rng rng = Rng::Stream(seed, "kinds");
      task.Prepare(with, rng);
      for (const std::string& object : task.objects()) kinds.insert(task.kind_of(object));
    }
    return std::vector<std::string>(kinds.begin(), kinds.end());
  };
  EXPECT_THAT(DefaultObjectKinds(), IsSupersetOf(drawn({})));
  EXPECT_THAT(ObjectKindsOf({"fruit"}),
              IsSupersetOf(drawn({.objects = {"fruit"}, .references = {"fruit"}})));
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
  const Scene panel = SceneWithUnit("button_panel"), lid = SceneWithUnit("lid_box");
  ExpectThrow<ArgumentError>([&] { JointTask(PressTaskConfig{.object = "unit"}).Begin(lid); },
                             "no joint that can be pressed");
  ExpectThrow<NotFoundError>(
      [&] {
        JointTask(PressTaskConfig{.object = "unit", .joint = "red_buton_slide"}).Begin(panel);
      },
      "Did you mean 'red_button_slide'");
}

}  // namespace
}  // namespace robocell
