#include "robocell/task/drawn_objects.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "robocell/scene/testing/scenes.h"

namespace robocell::internal {
namespace {

TEST(DrawnObjects, AreFoundByTheirNamesUnlessTheRigHasThem) {
  SceneSpec spec{.name = "room", .timestep = 0.002, .add_floor = true, .add_skybox = true};
  double x = 0;
  for (const char* name : {"target_box", "cube", "target_mug", "goal_tray", "target_of_rig"})
    spec.objects.push_back(BoxObject(name, {x += 0.1, 0, 0.02}));
  const Scene scene = Scene::Build(spec);
  TaskSetting setting{.place = "test", .robots = {}};
  setting.objects["target_of_rig"] = Pose();
  std::vector<std::string> found;
  for (const DrawnObject& each : DrawnObjects(scene, setting, kTarget, {}))
    found.push_back(each.name + " is a " + each.kind);
  EXPECT_THAT(found, ::testing::ElementsAre("target_box is a box", "target_mug is a mug"));
  EXPECT_EQ(DrawnObjects(scene, setting, kGoal, {}).front().kind, "tray");
}

TEST(DrawnObjects, ASingleKindHasTheNameThatItHasInRuns) {
  EXPECT_EQ(NameOfDrawn(kTarget, "mug", {"mug"}), "target");
  EXPECT_EQ(NameOfDrawn(kTarget, "mug", {"mug", "box"}), "target_mug");
  EXPECT_EQ(NameOfDrawn(kGoal, "tray", {}), "goal_tray");
  SceneSpec spec{.name = "room", .timestep = 0.002, .add_floor = true, .add_skybox = true};
  spec.objects.push_back(BoxObject("target", {0, 0, 0.02}));
  const Scene scene = Scene::Build(spec);
  const TaskSetting setting{.place = "test", .robots = {}};
  const std::vector<DrawnObject> found = DrawnObjects(scene, setting, kTarget, {"mug"});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].name + " is a " + found[0].kind, "target is a mug");
  EXPECT_TRUE(DrawnObjects(scene, setting, kTarget, {"mug", "box"}).empty());
}

TEST(PlaceFeature, HasThreeBoundedNumbers) {
  const Feature feature = PlaceFeature("goal", "Where it is.");
  EXPECT_EQ(feature.column.shape, std::vector<int64_t>{3});
  EXPECT_EQ(feature.column.frame, "shared base frame");
  EXPECT_EQ(feature.lower, std::vector<double>(3, -kFarthestObject));
  EXPECT_EQ(feature.upper, std::vector<double>(3, kFarthestObject));
}

}  // namespace
}  // namespace robocell::internal
