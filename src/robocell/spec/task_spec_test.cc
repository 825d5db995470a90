#include "robocell/spec/task_spec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/spec/env_config.h"
#include "robocell/spec/run_config.h"
#include "robocell/spec/testing/messages.h"
#include "robocell/spec/testing/pour_task.h"
#include "robocell/spec/yaml.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::ParseError;

TEST(TaskSpec, IsPickUnlessSaidOtherwise) {
  EXPECT_EQ(TaskSpec().kind(), "pick");
  EXPECT_EQ(Parse("{lift_height: 0.07}").task.As<PickTaskConfig>().lift_height, 0.07);
}

TEST(TaskSpec, EachKindHasItsOwnFields) {
  const TaskSpec place = Parse("{kind: pick_and_place, goal_tolerance: 0.02}").task;
  EXPECT_EQ(place.As<PickAndPlaceTaskConfig>().goal_tolerance, 0.02);
  EXPECT_EQ(place.If<PickTaskConfig>(), nullptr);
  ExpectThrow<SpecError>([&] { (void)place.As<PickTaskConfig>(); },
                         "task: is of kind pick_and_place, where fields of pick are needed");
  EXPECT_THAT(ParseError<RunConfig>(kRunHead + "task: {kind: pick, gaol: [0, 0, 0]}\n"),
              HasSubstr("a PickTaskConfig: no field 'gaol'"));
}

TEST(TaskSpec, WhatOnlyEnvironmentsSayIsRefusedInARun) {
  EXPECT_THAT(ParseError<RunConfig>(kRunHead + "task: {kind: pick_and_place, goal: [0, 0, 0]}\n"),
              HasSubstr("task.goal: belongs to environments, whose objects have ids and places; a "
                        "run chooses what they are put on among the kinds in `goals`"));
  EXPECT_THAT(ParseError<RunConfig>(kRunHead + "task: {kind: pick_and_place, object: cube}\n"),
              HasSubstr("task.object: belongs to environments"));
}

TEST(TaskSpec, BothKindsOfPickTellTheirStarts) {
  const auto pick = PickRunOf(PickTaskConfig{.lift_height = 0.08, .objects = {"mug"}});
  const auto place = PickRunOf(PickAndPlaceTaskConfig{.lift_height = 0.08, .objects = {"mug"}});
  for (const auto& run : {pick, place}) {
    ASSERT_TRUE(run);
    EXPECT_EQ(run->lift_height, 0.08);
    EXPECT_EQ(run->objects.names, std::vector<std::string>{"mug"});
  }
  RegisterPour();
  EXPECT_FALSE(PickRunOf(TaskSpec("pour_of_test")));
}

TEST(TaskSpec, UnknownKindsNameTheNearest) {
  EXPECT_THAT(ParseError<RunConfig>(kRunHead + "task: {kind: pik}\n"),
              HasSubstr("Did you mean 'pick'?"));
  EXPECT_THAT(ParseError<RunConfig>(kRunHead + "task: pick\n"), HasSubstr("write {kind: pick}"));
}

TEST(TaskSpec, EnvironmentsNameThemAlike) {
  RegisterPour();
  const auto env = ParseYaml<EnvConfig>(
      "robots: {a: {name: a, model: b}}\ntask: {kind: pour_of_test}\n", "env.yaml", "");
  EXPECT_EQ(env.task->kind(), "pour_of_test");
}

}  // namespace
}  // namespace robocell
