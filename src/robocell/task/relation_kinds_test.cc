#include "robocell/task/relation_kinds.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/spec/run_config.h"
#include "robocell/task/relation_task_config.h"
#include "robocell/task/task_kind.h"

namespace robocell {
namespace {

using ::testing::HasSubstr;

TEST(RelationKinds, AreRegisteredWithTheirFields) {
  for (const char* kind : {"relations", "stack", "place_next_to", "open", "close", "press", "push",
                           "insert", "sort", "wipe", "pour"}) {
    EXPECT_TRUE(FindTaskKind(kind)->is_built_in()) << kind;
    EXPECT_EQ(TaskSpec(kind).kind(), kind);
  }
}

TEST(RelationKinds, RejectUnknownKindsOfObjectsAndNamesThatAreTaken) {
  const auto mistakes = [](TaskSpec task) {
    RunConfig run;
    run.task = std::move(task);
    Problems problems;
    run.task.rules()->ValidateRun(run, problems);
    std::string text;
    for (const Problem& problem : problems.list())
      text += problem.path + ": " + problem.message + "\n";
    return text;
  };
  EXPECT_THAT(mistakes(RelationsTaskConfig{.objects = {"a=mgu"}, .goal = {"a held"}}),
              HasSubstr("Did you mean 'mug'?"));
  EXPECT_THAT(mistakes(RelationsTaskConfig{.objects = {"a=mug", "a=box"}, .goal = {"a held"}}),
              HasSubstr("has the name 'a' of another one"));
  EXPECT_THAT(mistakes(OpenTaskConfig{.object = "door", .objects = {"drawer_unit"}}),
              HasSubstr("leave one of them out"));
  EXPECT_EQ(mistakes(PressTaskConfig{}), "");
  EXPECT_EQ(mistakes(PlaceNextToTaskConfig{.objects = {"fruit"}, .references = {"fruit", "tray"}}),
            "");
  EXPECT_EQ(mistakes(PushTaskConfig{.objects = {"fruit"}}), "");
  EXPECT_EQ(mistakes(RelationsTaskConfig{.objects = {"a=fruit"}, .goal = {"a held"}}), "");
}

}  // namespace
}  // namespace robocell
