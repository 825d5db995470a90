#include "robocell/spec/task_spec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/spec/env_config.h"
#include "robocell/spec/run_config.h"
#include "robocell/spec/testing/messages.h"
#include "robocell/spec/value_fields.h"
#include "robocell/spec/yaml.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::ParseError;

const std::string kRunHead = "run: r\nrobot: {name: a, model: b}\noutput: o\n";

RunConfig Parse(const std::string& task) {
  return ParseYaml<RunConfig>(kRunHead + "task: " + task + "\n", "run.yaml", "");
}

// A kind of this test's own, registered once.
struct PourConfig {
  double angle = 0.5;
  NameList cups = {};

  static constexpr const char* kKind = "pour_of_test";
  static constexpr const char* kTypeName = "PourConfig";
  template <class V>
  static void Fields(V&& v) {
    v("angle", &PourConfig::angle, "How far to tilt, radians.", Bound::kPositive);
    v("cups", &PourConfig::cups, "Names of the cups.");
  }
};

void RegisterPour() {
  static const bool kDone = [] {
    RegisterTaskFields(PourConfig::kKind, std::make_shared<KindFieldsOf<PourConfig>>());
    return true;
  }();
  (void)kDone;
}

TEST(TaskSpec, IsPickUnlessSaidOtherwise) {
  EXPECT_EQ(TaskSpec().kind(), "pick");
  EXPECT_EQ(Parse("{lift_height: 0.07}").task.As<PickTaskConfig>().lift_height, 0.07);
}

TEST(TaskSpec, CopiesAreDeep) {
  TaskSpec a = PickTaskConfig{.lift_height = 0.1};
  TaskSpec b = a;
  b.As<PickTaskConfig>().lift_height = 0.2;
  EXPECT_EQ(a.As<PickTaskConfig>().lift_height, 0.1);
  EXPECT_FALSE(a == b);
  EXPECT_FALSE(a == TaskSpec(PickAndPlaceTaskConfig()));
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

TEST(TaskSpec, ARegisteredStructReadsWritesAndValidates) {
  RegisterPour();
  EXPECT_THAT(TaskKinds(), Contains("pour_of_test"));
  const RunConfig run = Parse("{kind: pour_of_test, angle: 1.2, cups: [a, b]}");
  EXPECT_EQ(run.task.As<PourConfig>().angle, 1.2);
  EXPECT_TRUE(ParseYaml<RunConfig>(ToYaml(run), "again", "") == run);
  EXPECT_THAT(ParseError<RunConfig>(kRunHead + "task: {kind: pour_of_test, angle: -1}\n"),
              HasSubstr("task.angle"));
  EXPECT_THROW(RegisterTaskFields(PourConfig::kKind, std::make_shared<KindFieldsOf<PourConfig>>()),
               ArgumentError);
}

TEST(TaskSpec, NamedValuesReadAndWriteByTheTypeOfTheirDefaults) {
  static const bool kRegistered = [] {
    RegisterTaskFields(
        "values_of_test",
        std::make_shared<ValueFields>(ValueFields(
            {{"height", 0.05}, {"count", int64_t{2}}, {"names", std::vector<std::string>{"a"}}})));
    return true;
  }();
  (void)kRegistered;
  const RunConfig run = Parse("{kind: values_of_test, height: 0.3, names: [x, y]}");
  const auto* fields = run.task.If<ValueFields>();
  ASSERT_NE(fields, nullptr);
  EXPECT_THAT(fields->names(), ElementsAre("height", "count", "names"));
  EXPECT_EQ(std::get<double>(fields->list()[0].value), 0.3);
  EXPECT_EQ(std::get<int64_t>(fields->list()[1].value), 2);
  EXPECT_TRUE(ParseYaml<RunConfig>(ToYaml(run), "again", "") == run);
  EXPECT_THAT(ParseError<RunConfig>(kRunHead + "task: {kind: values_of_test, hight: 1}\n"),
              HasSubstr("Did you mean 'height'?"));
  EXPECT_THAT(ParseError<RunConfig>(kRunHead + "task: {kind: values_of_test, count: 1.5}\n"),
              HasSubstr("task.count"));
}

TEST(TaskSpec, EnvironmentsNameThemAlike) {
  RegisterPour();
  const auto env = ParseYaml<EnvConfig>(
      "robots: {a: {name: a, model: b}}\ntask: {kind: pour_of_test}\n", "env.yaml", "");
  EXPECT_EQ(env.task->kind(), "pour_of_test");
}

}  // namespace
}  // namespace robocell
