#include "robocell/spec/kind_fields.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/spec/env_config.h"
#include "robocell/spec/run_config.h"
#include "robocell/spec/task_spec.h"
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

TEST(KindFields, CopiesAreDeep) {
  RegisterPour();
  TaskSpec a = PourConfig{.angle = 0.1};
  TaskSpec b = a;
  b.As<PourConfig>().angle = 0.2;
  EXPECT_EQ(a.As<PourConfig>().angle, 0.1);
  EXPECT_FALSE(a == b);
  EXPECT_FALSE(a == TaskSpec());
}

TEST(KindFields, ARegisteredStructReadsWritesAndValidates) {
  RegisterPour();
  EXPECT_THAT(TaskKinds(), Contains("pour_of_test"));
  const RunConfig run = Parse("{kind: pour_of_test, angle: 1.2}");
  EXPECT_EQ(run.task.As<PourConfig>().angle, 1.2);
  EXPECT_TRUE(ParseYaml<RunConfig>(ToYaml(run), "again", "") == run);
  EXPECT_THAT(ParseError<RunConfig>(kRunHead + "task: {kind: pour_of_test, angle: -1}\n"),
              HasSubstr("task.angle"));
}

TEST(KindFields, RunsAndEnvironmentsApplyTheRulesOfTheKind) {
  RegisterPour();
  EXPECT_THAT(ParseError<RunConfig>(kRunHead + "task: {kind: pour_of_test, cups: [a]}\n"),
              HasSubstr("yaml:4:34: task.cups: belongs to environments"));
  const std::string env = "robots: {a: {name: a, model: b}}\ntask: {kind: pour_of_test";
  EXPECT_THAT(ParseError<EnvConfig>(env + "}\n"), HasSubstr("task.cups: is required"));
  EXPECT_EQ(ParseYaml<EnvConfig>(env + ", cups: [a]}\n").task->As<PourConfig>().cups.names,
            std::vector<std::string>{"a"});
}

TEST(KindRegistry, AKindHasFieldsRulesAndAUniqueName) {
  RegisterPour();
  const auto fields = std::make_shared<KindFieldsOf<PourConfig>>();
  const auto rules = std::make_shared<KindRules>();
  KindRegistry& registry = TaskKindRegistry();
  ExpectThrow<ArgumentError>(
      [&] {
        registry.Register(PourConfig::kKind, {fields, rules}, false);
      },
      "task 'pour_of_test' is registered already; choose another name");
  ExpectThrow<ArgumentError>(
      [&] {
        registry.Register("none", {nullptr, rules}, false);
      },
      "task 'none' is registered without its fields; give the defaults");
  ExpectThrow<ArgumentError>(
      [&] {
        registry.Register("none", {fields, nullptr}, false);
      },
      "task 'none' is registered without its rules");
  EXPECT_FALSE(registry.Has("none"));
}

}  // namespace
}  // namespace robocell
