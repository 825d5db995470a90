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

TEST(TaskSpec, HasADefaultKind) {
  EXPECT_EQ(TaskSpec().kind(), TaskKindRegistry().default_kind());
  EXPECT_EQ(Parse("{}").task, TaskSpec());
}

TEST(TaskSpec, EachKindHasItsOwnFields) {
  RegisterPour();
  const TaskSpec pour = Parse("{kind: pour_of_test, angle: 0.2}").task;
  EXPECT_EQ(pour.As<PourConfig>().angle, 0.2);
  EXPECT_EQ(TaskSpec().If<PourConfig>(), nullptr);
  ExpectThrow<SpecError>([&] { (void)TaskSpec().As<PourConfig>(); },
                         "task: is of kind pick, where fields of pour_of_test are needed");
  EXPECT_THAT(ParseError<RunConfig>(kRunHead + "task: {kind: pour_of_test, angel: 1}\n"),
              HasSubstr("a PourConfig: no field 'angel'"));
}

TEST(TaskSpec, SuggestsTheNearestKind) {
  EXPECT_THAT(ParseError<RunConfig>(kRunHead + "task: {kind: pik}\n"),
              HasSubstr("Did you mean 'pick'?"));
  EXPECT_THAT(ParseError<RunConfig>(kRunHead + "task: pick\n"), HasSubstr("write {kind: pick}"));
}

TEST(TaskSpec, EnvironmentsUseTheSameKinds) {
  RegisterPour();
  const auto env = ParseYaml<EnvConfig>(
      "robots: {a: {name: a, model: b}}\ntask: {kind: pour_of_test, cups: [a]}\n", "env.yaml", "");
  EXPECT_EQ(env.task->kind(), "pour_of_test");
}

}  // namespace
}  // namespace robocell
