#include "robocell/spec/kind_fields.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
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

TEST(KindFields, CopiesAreDeep) {
  TaskSpec a = PickTaskConfig{.lift_height = 0.1};
  TaskSpec b = a;
  b.As<PickTaskConfig>().lift_height = 0.2;
  EXPECT_EQ(a.As<PickTaskConfig>().lift_height, 0.1);
  EXPECT_FALSE(a == b);
  EXPECT_FALSE(a == TaskSpec(PickAndPlaceTaskConfig()));
}

TEST(KindFields, ARegisteredStructReadsWritesAndValidates) {
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

}  // namespace
}  // namespace robocell
