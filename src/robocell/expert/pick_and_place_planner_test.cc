#include "robocell/expert/pick_and_place_planner.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <memory>

#include "robocell/base/error.h"
#include "robocell/task/pick_task.h"
#include "robocell/task/pick_task_config.h"
#include "robocell/task/start_sampler.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/long_form.h"
#include "robocell/testing/pick_scene.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;

struct PlaceOutcome {
  bool success = false;
  std::string failure;
  std::vector<std::string> phases;  // in order, without repetitions
  int rows = 0;
};
using PlaceMeddle = std::function<void(Scene&, const PickAndPlacePlanner&)>;

EpisodeStart StartWith(const RunConfig& run, uint64_t seed) {
  StartSampler sampler(run);
  for (int attempt = 0; attempt < 20; ++attempt) {
    Rng rng = Rng::Stream(seed, "start", attempt);
    SampleResult result = sampler.Sample({.attempt = attempt}, rng);
    if (result.start) return std::move(*result.start);
  }
  throw Error("no start in 20 attempts");
}

RunConfig RunOf(const std::string& kind) {
  RunConfig run = ExampleRun("pick_and_place.yaml");
  run.task.As<PickAndPlaceTaskConfig>().objects = {kind};
  return run;
}

PlaceOutcome RollOutPlace(const RunConfig& run, EpisodeStart& start,
                          const PlaceMeddle& meddle = {}) {
  PlaceOutcome outcome;
  Rng rng = Rng::Stream(1, "planner");
  Scene scene = start.scene;
  Robot robot = RobotsOf(scene).front();
  start.task->Begin(scene);
  PickAndPlacePlanner planner(run, start);
  planner.Begin(scene, rng);
  while (!planner.done() && outcome.rows < 600) {
    if (meddle) meddle(scene, planner);
    const Action action = planner.Act(scene, rng);
    const std::string phase = planner.phase_names()[planner.phase()];
    if (outcome.phases.empty() || outcome.phases.back() != phase) outcome.phases.push_back(phase);
    EXPECT_TRUE(robot.Apply(action.at(robot.name())).ok);
    for (int i = 0; i < 33; ++i) {
      robot.Update();
      EXPECT_TRUE(scene.Step().ok());
    }
    start.task->Judge(scene);  // it remembers that the object was lifted
    ++outcome.rows;
  }
  outcome.success = start.task->Judge(scene).success;
  outcome.failure = planner.failure();
  return outcome;
}

TEST(PickAndPlacePlanner, PlacesTheKindsOnTheTray) {
  const std::vector<std::string> kinds = DefaultObjectKinds();
  for (size_t i = 0; i < kinds.size(); i += LongForm() ? 1 : 3) {
    const std::string& kind = kinds[i];
    const RunConfig run = RunOf(kind);
    EpisodeStart start = StartWith(run, 3);
    const PlaceOutcome outcome = RollOutPlace(run, start);
    EXPECT_TRUE(outcome.success) << kind << ": " << outcome.failure;
    EXPECT_EQ(outcome.failure, "");
    EXPECT_THAT(outcome.phases, ElementsAre("open", "pregrasp", "grasp", "close", "lift",
                                            "transfer", "lower", "release", "retreat", "done"));
    EXPECT_LT(outcome.rows, 250);
  }
}

// At the goal itself a tall cylinder would be inside the table.
TEST(PickAndPlacePlanner, PutsATallObjectDownAboveALowGoal) {
  RunConfig run = RunOf("cylinder");
  run.task.As<PickAndPlaceTaskConfig>().goal = Vec3{0.1, 0.1, 0.48};
  double highest = 0;
  for (uint64_t seed = 0; seed < 8 && highest < 0.005; ++seed) {
    EpisodeStart start = StartWith(run, seed);
    start.task->Begin(start.scene);
    const auto& task = dynamic_cast<const PickAndPlaceTask&>(*start.task);
    highest = std::max(highest, task.RiseOverGoal(start.scene));
    EXPECT_LE(highest, run.task.As<PickAndPlaceTaskConfig>().goal_tolerance);
    if (highest < 0.005) continue;
    const PlaceOutcome outcome = RollOutPlace(run, start);
    EXPECT_TRUE(outcome.success) << outcome.failure;
  }
  EXPECT_GE(highest, 0.005) << "no cylinder was tall enough";
}

TEST(PickAndPlacePlanner, PicksUpASlippedObjectAgain) {
  const RunConfig run = RunOf("box");
  EpisodeStart start = StartWith(run, 3);
  const Pose before = start.scene.body_pose(start.scene.compiled()->object("target").root_body);
  bool done = false;
  const PlaceOutcome outcome =
      RollOutPlace(run, start, [&](Scene& scene, const PickAndPlacePlanner& planner) {
        if (done || planner.phase_names()[planner.phase()] != "transfer") return;
        done = true;
        scene.SetBodyPose(scene.compiled()->object("target").root_body, before);
      });
  EXPECT_TRUE(done);
  EXPECT_TRUE(outcome.success) << outcome.failure;
  EXPECT_EQ(std::count(outcome.phases.begin(), outcome.phases.end(), "pregrasp"), 2);
}

TEST(PickAndPlacePlanner, GivesUpIfTheGoalIsOutOfReach) {
  const RunConfig run = RunOf("box");
  EpisodeStart start = StartWith(run, 3);
  bool moved = false;
  const PlaceOutcome outcome =
      RollOutPlace(run, start, [&](Scene& scene, const PickAndPlacePlanner& planner) {
        if (moved || planner.phase_names()[planner.phase()] != "close") return;
        moved = true;
        scene.SetBodyPose(scene.compiled()->object("goal").root_body,
                          Pose(Eigen::Vector3d(5, 0, 0.009)));
      });
  EXPECT_FALSE(outcome.success);
  EXPECT_EQ(outcome.failure, "no way to put the object down");
}

// One of several arms that reaches the object and not the goal leaves the object to the others.
TEST(PickAndPlacePlanner, GraspsNothingThatItCannotPutDown) {
  const RunConfig run = RunOf("box");
  EpisodeStart start = StartWith(run, 3);
  start.scene.SetBodyPose(start.scene.compiled()->object("goal").root_body,
                          Pose(Eigen::Vector3d(5, 0, 0.009)));
  start.scene.Forward();
  const PlaceOutcome outcome = RollOutPlace(run, start);
  EXPECT_EQ(outcome.rows, 0);
  EXPECT_EQ(outcome.failure, "no grasp from which the goal can be reached");
}

// Beside its own condition for grasps it keeps the caller's.
TEST(PickAndPlacePlanner, GraspsNothingThatItsCallerRejects) {
  const RunConfig run = RunOf("box");
  EpisodeStart start = StartWith(run, 3);
  start.task->Begin(start.scene);
  PickPlannerOptions options;
  options.usable = [](PlanningScene&, const GraspMotion&) { return false; };
  PickAndPlacePlanner planner(RobotsOf(start.scene).front().name(), start.target_object,
                              std::dynamic_pointer_cast<const PickAndPlaceTask>(start.task),
                              run.options, options);
  Rng rng = Rng::Stream(1, "planner");
  planner.Begin(start.scene, rng);
  EXPECT_EQ(planner.failure(), "no grasp from which the goal can be reached");
}

TEST(PickAndPlacePlanner, RequiresATaskOfItsKind) {
  const RunConfig run = RunOf("box");
  EpisodeStart start = StartWith(run, 3);
  start.task =
      std::make_shared<PickTask>("target", "box", std::vector<std::string>{"target"}, 0.05);
  ExpectThrow<SpecError>([&] { PickAndPlacePlanner(run, start); },
                         "demonstrates tasks of kind pick_and_place");
}

}  // namespace
}  // namespace robocell
