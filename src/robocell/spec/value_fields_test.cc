#include "robocell/spec/value_fields.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/spec/run_config.h"
#include "robocell/spec/task_spec.h"
#include "robocell/spec/testing/messages.h"
#include "robocell/spec/testing/pour_task.h"
#include "robocell/spec/yaml.h"

namespace robocell {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::ParseError;

TEST(ValueFields, NamedValuesHaveTheTypeOfTheirDefaults) {
  static const bool kRegistered = [] {
    const ValueFields fields(
        {{"height", 0.05}, {"count", int64_t{2}}, {"names", std::vector<std::string>{"a"}}});
    TaskKindRegistry().Register(
        "values_of_test", {std::make_shared<ValueFields>(fields), std::make_shared<KindRules>()},
        false);
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

}  // namespace
}  // namespace robocell
