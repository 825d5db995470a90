// One start of each kind of task with the built-in arm. The table in docs/tasks.md has more robots
// and starts.
#include "robocell/expert/skill_expert.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/task/relation_task_config.h"
#include "robocell/task/start_sampler.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/pick_scene.h"

namespace robocell {
namespace {

using ::testing::IsSupersetOf;

struct SkillOutcome {
  bool success = false;
  std::string failure;
  std::vector<std::string> phases;  // in order, without repetitions
};

SkillOutcome RollOutSkills(const TaskSpec& task, uint64_t seed = 1) {
  RunConfig run = ExampleRun("pick_and_place.yaml");
  run.start = {};
  run.task = task;
  StartSampler sampler(run);
  for (int attempt = 0; attempt < 40; ++attempt) {
    Rng rng = Rng::Stream(seed, "start", attempt);
    SampleResult sample = sampler.Sample({.attempt = attempt}, rng);
    if (!sample.start) continue;
    Scene scene = sample.start->scene;
    Robot robot = RobotsOf(scene).front();
    Task& judge = *sample.start->task;
    judge.Begin(scene);
    SkillOutcome outcome;
    EXPECT_FALSE(judge.Judge(scene).success);
    const std::shared_ptr<Expert> expert =
        FindExpertKind(task.kind())->Make(run, *sample.start);
    expert->Begin(scene, rng);
    for (int row = 0; row < 700 && !expert->done(); ++row) {
      const Action action = expert->Act(scene, rng);
      const std::string phase = expert->phase_names()[static_cast<size_t>(expert->phase())];
      if (outcome.phases.empty() || outcome.phases.back() != phase) outcome.phases.push_back(phase);
      if (action.contains(robot.name())) {
        EXPECT_TRUE(robot.Apply(action.at(robot.name())).ok);
      }
      for (int i = 0; i < 33; ++i) {
        robot.Update();
        EXPECT_TRUE(scene.Step().ok());
      }
      const TaskVerdict verdict = judge.Judge(scene);
      EXPECT_GE(verdict.progress, 0);
      EXPECT_LE(verdict.progress, 1);
      outcome.success = verdict.success;
    }
    outcome.failure = expert->failure();
    return outcome;
  }
  throw Error("no start in 40 attempts");
}

TEST(SkillExpert, StacksTwoCubes) {
  const SkillOutcome outcome = RollOutSkills(StackTaskConfig{});
  EXPECT_TRUE(outcome.success) << outcome.failure;
  EXPECT_THAT(outcome.phases, IsSupersetOf({"grasp", "lift", "transfer", "lower", "release"}));
}

TEST(SkillExpert, PlacesOneObjectNextToAnother) {
  const SkillOutcome outcome =
      RollOutSkills(PlaceNextToTaskConfig{.objects = {"box"}, .references = {"mug"}});
  EXPECT_TRUE(outcome.success) << outcome.failure;
}

TEST(SkillExpert, OpensADrawerADoorAndALid) {
  for (const char* kind : {"chest", "cupboard", "lid_box"}) {
    const SkillOutcome outcome = RollOutSkills(OpenTaskConfig{.objects = {kind}});
    EXPECT_TRUE(outcome.success) << kind << ": " << outcome.failure;
    EXPECT_THAT(outcome.phases, IsSupersetOf({"reach", "approach", "close", "follow", "release"}));
  }
}

TEST(SkillExpert, ClosesADrawer) {
  const SkillOutcome outcome = RollOutSkills(CloseTaskConfig{.objects = {"chest"}});
  EXPECT_TRUE(outcome.success) << outcome.failure;
}

TEST(SkillExpert, PressesAButton) {
  const SkillOutcome outcome = RollOutSkills(PressTaskConfig{});
  EXPECT_TRUE(outcome.success) << outcome.failure;
  EXPECT_THAT(outcome.phases, IsSupersetOf({"reach", "approach", "press"}));
}

TEST(SkillExpert, PushesABlockIntoARegion) {
  const SkillOutcome outcome = RollOutSkills(PushTaskConfig{});
  EXPECT_TRUE(outcome.success) << outcome.failure;
  EXPECT_THAT(outcome.phases, IsSupersetOf({"reach", "approach", "push", "retreat"}));
}

// Two relations in a file: the second one holds something at the end.
TEST(SkillExpert, BringsAboutTheRelationsOfAFile) {
  const SkillOutcome outcome = RollOutSkills(RelationsTaskConfig{
      .objects = {"red=box", "tray", "nut"}, .goal = {"red on tray", "nut held"}});
  EXPECT_TRUE(outcome.success) << outcome.failure;
}

TEST(SkillExpert, RejectsATaskWithoutRelations) {
  RunConfig run = ExampleRun("pick_and_place.yaml");
  ExpectThrow<SpecError>([&] { SkillExpert(run, EpisodeStart{}); },
                         "demonstrates tasks whose goals are relations");
}

}  // namespace
}  // namespace robocell
