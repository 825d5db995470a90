#include "robocell/task/pick_and_place_task.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "robocell/base/error.h"
#include "robocell/scenes/catalogue.h"
#include "robocell/task/start_sampler.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/source_dir.h"

namespace robocell::internal {
namespace {

using ::testing::Contains;
using ::testing::Not;

// The oracle is the simulation: what is let go where the goal is comes to rest there.
TEST(PickAndPlaceTask, AGoalOnAnObjectIsTheRestPose) {
  for (const char* kind : {"box", "mug", "bottle", "cylinder"}) {
    SceneSpec spec{.name = "test", .timestep = 0.002, .add_floor = true, .add_skybox = false};
    Rng rng = Rng::Stream(3, "goal", kind);
    SceneObject object = MakeCatalogueObject(kind, "thing", rng);
    object.pos = {0.5, 0, ObjectSizes().Of(object).height};
    spec.objects.push_back(object);
    SceneObject tray = PickAndPlaceTask::MakeGoalObject("tray", "tray", rng);
    tray.pos = {0, 0, 0.009};
    tray.quat = Pose::FromRpy({0, 0, 0}, {0, 0, 0.4}).quaternion();
    spec.objects.push_back(tray);
    Scene scene = Scene::Build(spec);
    scene.Reset();
    ASSERT_TRUE(scene.StepN(500).ok());
    PickAndPlaceTask task({.object = "thing", .goal_object = "tray"});
    task.Bind(scene, {.place = "test", .robots = {}});
    task.Begin(scene);
    const std::string body = scene.compiled()->object("thing").root_body;
    const Eigen::Vector3d goal = task.GoalInWorld();
    scene.SetBodyPose(body,
                      {goal + Eigen::Vector3d(0, 0, 0.001), scene.body_pose(body).quaternion()});
    ASSERT_TRUE(scene.StepN(500).ok());
    EXPECT_LT((scene.body_pose(body).translation() - goal).norm(), 1e-3) << kind;
    // It goes along with the tray, and is remembered.
    const std::vector<double> memory = task.memory();
    PickAndPlaceTask again({.object = "thing", .goal_object = "tray"});
    again.Bind(scene, {.place = "test", .robots = {}});
    again.Recall(memory);
    EXPECT_TRUE(again.GoalInWorld().isApprox(task.GoalInWorld(), 1e-12));
  }
}

TEST(PickAndPlaceTask, RequiresAGoalThatIsNamedOrPrepared) {
  SceneSpec spec{.name = "test", .timestep = 0.002, .add_floor = true, .add_skybox = false};
  Rng rng = Rng::Stream(3, "goal");
  spec.objects.push_back(MakeCatalogueObject("box", "thing", rng));
  Scene scene = Scene::Build(spec);
  PickAndPlaceTask task({.object = "thing"});
  ExpectThrow<ArgumentError>([&] { task.Bind(scene, {.place = "here", .robots = {}}); },
                             "here: the scene has no goal object of the task; set task.goal");
}

RunConfig PlaceRun() { return RunConfig::Load(SourceDir() + "/examples/pick_and_place.yaml"); }

std::vector<EpisodeStart> Starts(const RunConfig& run, int count) {
  StartSampler sampler(run);
  std::vector<EpisodeStart> starts;
  for (int episode = 0; episode < count; ++episode) {
    for (int attempt = 0; attempt < 20; ++attempt) {
      Rng rng = Rng::Stream(5, episode, attempt);
      SampleResult result = sampler.Sample({.episode = episode, .attempt = attempt}, rng);
      if (!result.start) continue;
      starts.push_back(std::move(*result.start));
      break;
    }
  }
  return starts;
}

TEST(PickAndPlaceTask, PlacesATrayAtTheGoalDistance) {
  RunConfig run = PlaceRun();
  run.task.As<PickAndPlaceTaskConfig>().goal_distance = 0.2;
  const std::vector<EpisodeStart> starts = Starts(run, 6);
  ASSERT_EQ(starts.size(), 6u);
  for (const EpisodeStart& start : starts) {
    ASSERT_GE(start.object_kinds.size(), 2u);
    EXPECT_EQ(start.object_kinds[1], "tray");
    const auto& task = dynamic_cast<const PickAndPlaceTask&>(*start.task);
    start.task->Begin(start.scene);
    const Scene& scene = start.scene;
    const Eigen::Vector3d target =
        scene.body_pose(scene.compiled()->object("target").root_body).translation();
    EXPECT_GE((task.GoalInWorld() - target).head<2>().norm(), 0.2);
    const Eigen::Vector3d tray =
        scene.body_pose(scene.compiled()->object("goal").root_body).translation();
    EXPECT_LT((task.GoalInWorld() - tray).head<2>().norm(), 1e-9);
    EXPECT_EQ(task.instruction(),
              "pick up the " + start.object_kinds[0] + " and put it on the tray");
    EXPECT_EQ(task.objects()[1], "goal");
  }
}

TEST(PickAndPlaceTask, InstructionsKeepTheNamesOfSceneObjects) {
  EXPECT_EQ(PickAndPlaceTask({.object = "red_cube", .goal_object = "tray_2"}).instruction(),
            "pick up the red_cube and put it on the tray_2");
}

TEST(PickAndPlaceTask, GoalsAreOfTheConfiguredKinds) {
  RunConfig run = PlaceRun();
  run.task.As<PickAndPlaceTaskConfig>().goals = {"tray", "nut"};
  run.task.As<PickAndPlaceTaskConfig>().objects = {"box"};
  std::set<std::string> kinds;
  for (const EpisodeStart& start : Starts(run, 12)) kinds.insert(start.object_kinds[1]);
  EXPECT_EQ(kinds, (std::set<std::string>{"tray", "nut"}));
}

// The gripper does not get into a mug.
TEST(PickAndPlaceTask, RefusalsNameTheKindOfTheGoal) {
  RunConfig run = PlaceRun();
  run.task.As<PickAndPlaceTaskConfig>().goals = {"mug"};
  run.task.As<PickAndPlaceTaskConfig>().objects = {"box"};
  StartSampler sampler(run);
  std::set<std::string> reasons;
  for (int episode = 0; episode < 4; ++episode) {
    Rng rng = Rng::Stream(5, episode);
    const SampleResult result = sampler.Sample({.episode = episode}, rng);
    if (!result.start) reasons.insert(result.refusal.counted_as());
    for (const auto& [reason, count] : result.redrawn()) reasons.insert(reason);
  }
  EXPECT_THAT(reasons, Contains("task: the object cannot be put down on the mug"));
}

TEST(PickAndPlaceTask, RejectsAGoalOutOfReachWithTheReason) {
  RunConfig run = PlaceRun();
  run.task.As<PickAndPlaceTaskConfig>().goal_distance = 0.7;  // the table is 0.5 by 0.8 m
  StartSampler sampler(run);
  std::set<std::string> reasons;
  for (int episode = 0; episode < 8; ++episode) {
    Rng rng = Rng::Stream(5, episode);
    const SampleResult result = sampler.Sample({.episode = episode}, rng);
    if (!result.start) reasons.insert(result.refusal.counted_as());
    for (const auto& [reason, count] : result.redrawn()) reasons.insert(reason);
  }
  EXPECT_THAT(reasons, Contains("task: no free place for the objects"));
}

TEST(PickAndPlaceTask, SuggestsTheNearestGoal) {
  Rng rng = Rng::Stream(1, "goal");
  ExpectThrow<NotFoundError>([&] { PickAndPlaceTask::MakeGoalObject("try", "goal", rng); },
                             "Did you mean 'tray'?");
  EXPECT_THAT(PickAndPlaceTask::AllGoalKinds(), Contains("tray"));
  EXPECT_THAT(PickAndPlaceTask::AllGoalKinds(), Contains("mug"));
}

// Returns the reasons of refusals of a run whose goal is a place over the table.
std::set<std::string> ReasonsAt(const Vec3& goal) {
  RunConfig run = PlaceRun();
  PickAndPlaceTaskConfig& task = run.task.As<PickAndPlaceTaskConfig>();
  task.objects = {"box"};
  task.goal = goal;
  StartSampler sampler(run);
  std::set<std::string> reasons;
  for (int episode = 0; episode < 6; ++episode) {
    Rng rng = Rng::Stream(5, episode);
    const SampleResult result = sampler.Sample({.episode = episode}, rng);
    reasons.insert(result.start ? "" : result.refusal.counted_as());
  }
  return reasons;
}

// The next start of a run has another object, and its base somewhere else.
TEST(PickAndPlaceTask, StartsOfARunAreRefusedIfTheGoalCannotBe) {
  EXPECT_EQ(ReasonsAt({0.1, 0.2, 0.7}),
            std::set<std::string>{"task: the object cannot come to rest at the goal"});
  EXPECT_THAT(ReasonsAt({3, 0.2, 0.02}), Not(Contains(""))) << "out of reach";
  EXPECT_THAT(ReasonsAt({0.1, 0.1, 0.48}), Contains(""));
}

}  // namespace
}  // namespace robocell::internal
