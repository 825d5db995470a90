#include "robocell/rollout/registered_kinds.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/rollout/testing/demo.h"
#include "robocell/spec/yaml.h"

namespace robocell::internal {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

TEST(UnregisteredKinds, KnowsTheBuiltInOnes) {
  EXPECT_THAT(UnregisteredKinds(ToYaml(Demo())), IsEmpty());
  EXPECT_THAT(UnregisteredKinds("features: [time, robots/*/sensors/*]"), IsEmpty());
}

TEST(UnregisteredKinds, NamesEachWithWhereToNameItsModule) {
  EXPECT_THAT(
      UnregisteredKinds("run: a\ntask: {kind: pik}\nscenes: {source: lab}\nfeatures: [heat]\n"),
      ElementsAre(
          AllOf(StartsWith("task.kind: no task 'pik'. "), HasSubstr("Did you mean 'pick'?"),
                HasSubstr("A task of your own is in a module, and a dataset imports none by "
                          "itself: name it with --import my_tasks.py")),
          AllOf(StartsWith("scenes.source: no scene source 'lab'. "),
                HasSubstr("A scene source of your own is in a module")),
          AllOf(StartsWith("features: no registered feature 'heat'. "),
                HasSubstr("A feature of your own is in a module"))));
}

TEST(UnregisteredKinds, LeavesOtherTextsToTheirReader) {
  for (const char* text : {"", "[", "3", "task: pick", "task: {kind: [a]}", "features: a"})
    EXPECT_THAT(UnregisteredKinds(text), IsEmpty()) << text;
}

}  // namespace
}  // namespace robocell::internal
