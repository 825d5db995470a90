#include "robocell/task/task_kind.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/task/pick_task.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/pick_scene.h"

namespace robocell {
namespace {

TEST(TaskKind, TheBuiltInOnesAreThere) {
  for (const char* kind : {"pick", "pick_and_place"})
    EXPECT_NE(FindTaskKind(kind)->Make(TaskSpec(kind)), nullptr) << kind;
  ExpectThrow<NotFoundError>([] { FindTaskKind("pik"); }, "Did you mean 'pick'?");
}

TEST(TaskKind, ItsFieldsAreRegisteredWithIt) {
  const auto pick = FindTaskKind("pick");
  ExpectThrow<ArgumentError>(
      [&] { RegisterTask("pick", std::make_shared<KindFieldsOf<PickTaskConfig>>(), pick); },
      "task 'pick' is registered already");
  ExpectThrow<ArgumentError>(
      [] { RegisterTask("none", std::make_shared<KindFieldsOf<PickTaskConfig>>(), nullptr); },
      "task 'none' needs a TaskKind");
  EXPECT_FALSE(IsTaskKind("none"));
}

TEST(TaskKind, PickHasOneOfEachKindOfObjectThatARunMayUse) {
  RunConfig run = ExampleRun("demo.yaml");
  EXPECT_EQ(FindTaskKind("pick")->Contents(run).size(), ObjectKinds().size());
  run.task.As<PickTaskConfig>().objects = {"mug"};
  const std::vector<SceneObject> contents = FindTaskKind("pick")->Contents(run);
  ASSERT_EQ(contents.size(), 1u);
  EXPECT_EQ(contents[0].name, "mug");
}

TEST(TaskKind, UnknownKindsOfObjectsAreProblemsOfTheirPlace) {
  RunConfig run = ExampleRun("demo.yaml");
  run.task.As<PickTaskConfig>().objects = {"box", "mgu"};
  Problems problems;
  FindTaskKind("pick")->ValidateRun(run, problems);
  ASSERT_EQ(problems.list().size(), 1u);
  EXPECT_EQ(problems.list()[0].path, "task.objects[1]");
  EXPECT_THAT(problems.list()[0].message, ::testing::HasSubstr("Did you mean 'mug'?"));
}

}  // namespace
}  // namespace robocell
