#include "robocell/task/pick_kind.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/scenes/catalogue.h"
#include "robocell/spec/testing/duo_env.h"
#include "robocell/spec/testing/messages.h"
#include "robocell/spec/testing/pour_task.h"
#include "robocell/task/pick_task_config.h"
#include "robocell/testing/pick_scene.h"

namespace robocell {
namespace {

using ::testing::HasSubstr;
using testing::ParseError;

TEST(PickKind, ARunWithoutAKindPicks) {
  EXPECT_EQ(TaskSpec().kind(), "pick");
  EXPECT_EQ(Parse("{lift_height: 0.07}").task.As<PickTaskConfig>().lift_height, 0.07);
}

TEST(PickKind, ATaskIsAboutAnObjectOfTheRig) {
  EnvConfig env = Duo();
  env.root_frame_objects["cube"] = Thing();
  env.task = PickTaskConfig{.object = "cub"};
  EXPECT_EQ(Message(env),
            "it is not valid: task.object: root_frame_objects: no object 'cub'. Its objects: cube. "
            "Did you mean 'cube'?");
  env.task->As<PickTaskConfig>().object = "cube";
  EXPECT_EQ(Message(env), "");
  env.world_frame_objects["ball"] = Thing();
  env.task->As<PickTaskConfig>().object = "ball";
  EXPECT_EQ(Message(env),
            "it is not valid: task.object: 'ball' is in world_frame_objects, which stay in the "
            "room; a task goes with the rig, and so do its objects: move it to root_frame_objects");
}

TEST(PickKind, RejectsInvalidObjectsAndGoalsOfATask) {
  EnvConfig env = Duo();
  env.root_frame_objects["cube"] = Thing();
  env.task = PickAndPlaceTaskConfig{.object = "cube"};
  EXPECT_EQ(Message(env),
            "it is not valid: task.goal: is required: where the object is to be put, for example "
            "[0.4, 0.2, 0], or goal_object, what it is to be put on");
  auto& task = env.task->As<PickAndPlaceTaskConfig>();
  task.goal = Vec3{0, 0, 0.02};
  task.goal_object = "cub";
  EXPECT_THAT(Message(env), HasSubstr("task.goal_object: root_frame_objects: no object 'cub'."));
  task.goal_object = "cube";
  EXPECT_THAT(Message(env), HasSubstr("task.goal_object: is the object that is to be put there"));
}

TEST(PickKind, DoubtsLengthsOfAnEnvironmentThatLookLikeMillimetres) {
  EnvConfig env = Duo();
  env.root_frame_objects["cube"] = Thing();
  const std::string doubt =
      "50 m is more than any arm reaches, and lengths are in metres. Is it in millimetres? Then "
      "write 0.05";
  env.task = PickTaskConfig{.object = "cube", .lift_height = 50};
  EXPECT_EQ(Message(env), "it is not valid: task.lift_height: " + doubt);
  env.task = PickTaskConfig{.object = "cube", .spread = {0, 50}};
  EXPECT_EQ(Message(env), "it is not valid: task.spread: " + doubt);
  PickAndPlaceTaskConfig place{.object = "cube", .goal = Vec3{0, 0, 0.02}};
  place.goal_distance = 50;
  env.task = place;
  EXPECT_EQ(Message(env), "it is not valid: task.goal_distance: " + doubt);
}

TEST(PickKind, RejectsTaskFieldsOfRuns) {
  EnvConfig env = Duo();
  env.root_frame_objects["cube"] = Thing();
  env.task = PickTaskConfig{.object = "cube", .objects = {"box"}};
  EXPECT_THAT(Message(env), HasSubstr("task.objects: belongs to runs"));
  env.task = PickAndPlaceTaskConfig{
      .object = "cube", .goal = Vec3{0, 0, 0.1}, .objects = {"mug"}, .goals = {"tray"}};
  EXPECT_THAT(Message(env), HasSubstr("task.objects: belongs to runs"));
  EXPECT_THAT(Message(env), HasSubstr("task.goals: belongs to runs"));
}

TEST(PickKind, RejectsEnvironmentFieldsInARun) {
  EXPECT_THAT(ParseError<RunConfig>(kRunHead + "task: {kind: pick_and_place, goal: [0, 0, 0]}\n"),
              HasSubstr("yaml:4:36: task.goal: belongs to environments, whose objects have ids and "
                        "places; a run chooses what they are put on among the kinds in `goals`"));
  EXPECT_THAT(ParseError<RunConfig>(kRunHead + "task: {kind: pick_and_place, object: cube}\n"),
              HasSubstr("task.object: belongs to environments"));
}

TEST(PickKind, ReportsUnknownObjectKindsAtTheirPlace) {
  const std::string error =
      ParseError<RunConfig>(kRunHead +
                            "task: {kind: pick_and_place, objects: [box, mgu], goals: "
                            "[try]}\n");
  EXPECT_THAT(error, HasSubstr("yaml:4:45: task.objects[1]: no kind of object 'mgu'"));
  EXPECT_THAT(error, HasSubstr("Did you mean 'mug'?"));
  EXPECT_THAT(error, HasSubstr("task.goals[0]: no kind of object 'try'"));
}

TEST(PickKind, HasOneObjectOfEachKind) {
  RunConfig run = ExampleRun("demo.yaml");
  EXPECT_EQ(FindTaskKind("pick")->Contents(run).size(), ObjectKinds().size());
  run.task.As<PickTaskConfig>().objects = {"mug"};
  const std::vector<SceneObject> contents = FindTaskKind("pick")->Contents(run);
  ASSERT_EQ(contents.size(), 1u);
  EXPECT_EQ(contents[0].name, "mug");
}

}  // namespace
}  // namespace robocell
