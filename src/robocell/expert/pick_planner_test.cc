#include "robocell/expert/pick_planner.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <string>
#include <utility>

#include "robocell/base/files.h"
#include "robocell/task/grasp_candidates.h"
#include "robocell/task/grasp_check.h"
#include "robocell/task/grasp_motion.h"
#include "robocell/task/pick_task.h"
#include "robocell/task/pick_task_config.h"
#include "robocell/task/start_sampler.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/long_form.h"
#include "robocell/testing/menagerie.h"
#include "robocell/testing/pick_scene.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;

// The result of a rollout.
struct Outcome {
  bool success = false;
  std::string failure;
  int rows = 0;
  std::vector<std::string> phases;  // in their order, repetitions left out
  double fastest = 0;               // step of a joint target between two actions, rad
  double closing = 0;               // step of the opening between two actions, at most
  std::vector<double> end;          // state of the scene
};

// Called before each action; may modify the scene.
using Meddle = std::function<void(Scene&, const PickPlanner&)>;

// Acts like a stepper, which belongs to a higher layer.
Outcome RollOut(Scene scene, Task& task, PickPlanner& planner, Rng& rng,
                const Meddle& meddle = {}) {
  Outcome outcome;
  Robot robot = RobotsOf(scene).front();
  task.Begin(scene);
  planner.Begin(scene, rng);
  std::vector<double> before = robot.arm().joint_pos();
  double opening = 1;
  while (!planner.done() && outcome.rows < 500) {
    if (meddle) meddle(scene, planner);
    const Action action = planner.Act(scene, rng);
    const RobotAction& commands = action.at(robot.name());
    const std::vector<double>& target = commands.at("arm").values;
    for (size_t i = 0; i < target.size(); ++i) {
      outcome.fastest = std::max(outcome.fastest, std::abs(target[i] - before[i]));
    }
    before = target;
    outcome.closing = std::max(outcome.closing, opening - commands.at("gripper").values.at(0));
    opening = commands.at("gripper").values.at(0);
    const std::string phase = planner.phase_names()[planner.phase()];
    if (outcome.phases.empty() || outcome.phases.back() != phase) outcome.phases.push_back(phase);
    EXPECT_TRUE(robot.Apply(commands).ok);
    for (int i = 0; i < 33; ++i) {
      robot.Update();
      EXPECT_TRUE(scene.Step().ok());
    }
    ++outcome.rows;
  }
  outcome.success = task.Judge(scene).success;
  outcome.failure = planner.failure();
  outcome.end = scene.state();
  return outcome;
}

struct Bench {
  explicit Bench(const std::string& kind, double distance = 0.42)
      : pick(MakePickScene(ObjectOnTheTable(kind), "demo.yaml", distance)),
        task("target", kind, {"target"}, 0.01),
        planner("rc7", "target", pick.run.options) {}
  explicit Bench(SceneObject object)
      : pick(MakePickScene(std::move(object))),
        task("target", "thing", {"target"}, 0.01),
        planner("rc7", "target", pick.run.options) {}
  Outcome Run(const Meddle& meddle = {}) { return RollOut(pick.scene, task, planner, rng, meddle); }

  PickScene pick;
  PickTask task;
  PickPlanner planner;
  Rng rng = Rng::Stream(1, "planner");
};

SceneObject ModelOnTheTable(const std::string& path) {
  SceneObject object{.name = "target", .mjcf_path = path};
  object.pos = {0, 0, 0.4505 + ObjectSizes().Of(object).height};
  return object;
}

// From above both are too wide: a bowl is held by its rim, a mushroom by its stem.
TEST(PickPlanner, PicksByTheRimAndFromTheSideWhatIsTooWideFromAbove) {
  const TempDir folder;
  AtomicWrite(folder / "mushroom.xml",
              R"(<mujoco><default><geom friction="1 .02 .001" condim="4"/></default>
      <worldbody><body name="mushroom"><freejoint/>
      <geom type="cylinder" size=".045 .006" pos="0 0 .006" mass=".15"/>
      <geom type="cylinder" size=".015 .06" pos="0 0 .072" mass=".03"/>
      <geom type="cylinder" size=".05 .01" pos="0 0 .142" mass=".03"/></body></worldbody></mujoco>)");
  for (const std::string& path : {std::string("receiver"), (folder / "mushroom.xml").string()}) {
    Bench bench(ModelOnTheTable(path));
    PlanningScene planning = bench.pick.planning();
    GraspMotions from_above(planning,
                            FindGrasps(planning.model(), planning.data(), planning.target_body(),
                                       *bench.pick.shape(), bench.pick.robot.tcp_in_world()),
                            bench.pick.home());
    ASSERT_FALSE(from_above.Next()) << path;
    EXPECT_FALSE(
        GraspCheck().Check(bench.pick.scene, bench.pick.robot, bench.pick.target_body, 0.01))
        << path;
    const Outcome outcome = bench.Run();
    EXPECT_TRUE(outcome.success) << path << ": " << outcome.failure;
  }
}

TEST(PickPlanner, PicksEveryKindAtTheFirstGrasp) {
  for (const std::string& kind : DefaultObjectKinds()) {
    Bench bench(kind);
    const Outcome outcome = bench.Run();
    EXPECT_TRUE(outcome.success) << kind << ": " << outcome.failure;
    EXPECT_EQ(outcome.failure, "");
    EXPECT_EQ(bench.planner.attempts(), 1);
    EXPECT_THAT(outcome.phases, ElementsAre("open", "pregrasp", "grasp", "close", "lift", "done"));
    EXPECT_LT(outcome.rows, 100);
    EXPECT_TRUE(bench.task.Judge(bench.pick.scene).success) << kind;
  }
}

TEST(PickPlanner, PicksObjectsOfOtherCategories) {
  for (const char* kind : {"apple", "block_arch", "can", "cup", "screwdriver"}) {
    Bench bench(kind);
    const Outcome outcome = bench.Run();
    EXPECT_TRUE(outcome.success) << kind << ": " << outcome.failure;
  }
}

TEST(PickPlanner, TargetsMoveNoFasterThanItsSpeedLimit) {
  Bench bench("box");
  EXPECT_LE(bench.Run().fastest, 1.2 * 0.066 + 1e-9);
}

TEST(PickPlanner, SameStreamSameRollout) {
  Bench a("mug"), b("mug");
  EXPECT_EQ(a.Run().end, b.Run().end);
}

TEST(PickPlanner, CannotActBeforeBegin) {
  Bench bench("box");
  ExpectThrow<Error>([&] { bench.planner.Act(bench.pick.scene, bench.rng); },
                     "PickPlanner: Act came before Begin was through");
}

TEST(PickPlanner, CanRestart) {
  Bench bench("box");
  const std::vector<double> start = bench.pick.scene.state();
  const Outcome first = bench.Run();
  bench.pick.scene.SetState(start);
  RobotsOf(bench.pick.scene).front().controller("arm").Reset();
  EXPECT_TRUE(first.success);
  EXPECT_TRUE(bench.Run().success);
  EXPECT_EQ(bench.planner.attempts(), 1);
}

// Moves the object sideways when the hand begins to close, `times` times.
Meddle Snatch(int times) {
  return [left = times, closing = false](Scene& scene, const PickPlanner& planner) mutable {
    const bool closes = planner.phase_names()[planner.phase()] == "close";
    if (closes && !closing && left > 0) {
      const Pose pose = scene.body_pose("target");
      const double y = left % 2 == 0 ? 0.12 : -0.12;
      scene.SetBodyPose("target",
                        Pose(pose.translation() + Eigen::Vector3d(0.02, y, 0), pose.quaternion()));
      --left;
    }
    closing = closes;
  };
}

TEST(PickPlanner, RetriesAtTheNewPlaceAfterAnEmptyGrasp) {
  Bench bench("box");
  const Outcome outcome = bench.Run(Snatch(1));
  EXPECT_TRUE(outcome.success) << outcome.failure;
  EXPECT_EQ(outcome.failure, "");
  EXPECT_EQ(bench.planner.attempts(), 2);
  EXPECT_THAT(outcome.phases, ElementsAre("open", "pregrasp", "grasp", "close", "open", "pregrasp",
                                          "grasp", "close", "lift", "done"));
}

// A finger may have pushed the object aside: a grasp is identified by the object's pose at the time
// of planning.
TEST(PickPlanner, TriesAnotherGraspAfterAnEmptyOne) {
  Bench bench("box");
  std::vector<Pose> grasps;  // TCP in the object's frame
  bool closing = false;
  const Meddle snatch = Snatch(2);
  bench.Run([&](Scene& scene, const PickPlanner& planner) {
    const bool closes = planner.phase_names()[planner.phase()] == "close";
    if (closes && !closing)
      grasps.push_back(scene.body_pose("target").inverse() * bench.pick.robot.tcp_in_world());
    closing = closes;
    snatch(scene, planner);
  });
  ASSERT_EQ(grasps.size(), 3u);
  for (size_t i = 1; i < grasps.size(); ++i) {
    for (size_t k = 0; k < i; ++k)
      EXPECT_FALSE(grasps[i].is_close(grasps[k], 0.2, 0.004)) << i << " is " << k << " again";
  }
}

TEST(PickPlanner, ClosesSlowlyEnoughForContacts) {
  Bench bench("mug");
  const Outcome outcome = bench.Run();
  const Interval gap = bench.pick.robot.gripper().inter_finger_dist_range();
  EXPECT_TRUE(outcome.success) << outcome.failure;
  EXPECT_GT(outcome.closing, 0);
  EXPECT_LE(outcome.closing * (gap.upper - gap.lower), 0.2 * 0.066 + 1e-4);
}

TEST(PickPlanner, GivesUpAfterThreeGraspsAndReportsTheReason) {
  Bench bench("box");
  const Outcome outcome = bench.Run(Snatch(3));
  EXPECT_FALSE(outcome.success);
  EXPECT_EQ(outcome.failure, "the hand closed on nothing");
  EXPECT_EQ(bench.planner.attempts(), 3);
}

TEST(PickPlanner, DetectsALostObject) {
  Bench bench("sphere");
  bool pulled = false;
  const Outcome outcome = bench.Run([&](Scene& scene, const PickPlanner& planner) {
    if (pulled || scene.body_pose("target").translation().z() < 0.5) return;
    pulled = planner.phase_names()[planner.phase()] == "lift";
    scene.SetBodyPose("target", Pose({-0.02, 0.1, 0.48}, Quaternion{0, 0, 0, 1}));
  });
  EXPECT_TRUE(pulled);
  EXPECT_TRUE(outcome.success) << outcome.failure;
  EXPECT_EQ(bench.planner.attempts(), 2);
}

// Pushes the hand aside with 400 N for half a second.
TEST(PickPlanner, NoticesABlockedArmAndContinuesAfterwards) {
  Bench bench("box");
  int pushed = 0;
  const Outcome outcome = bench.Run([&](Scene& scene, const PickPlanner& planner) {
    const bool moving = planner.phase_names()[planner.phase()] == "pregrasp";
    const bool push = (moving || pushed > 0) && pushed < 8;
    pushed += push;
    scene.SetBodyWrench("robot_0/hand", {0, push ? 400.0 : 0.0, 0}, {0, 0, 0});
  });
  EXPECT_EQ(pushed, 8);
  EXPECT_TRUE(outcome.success) << outcome.failure;
  EXPECT_EQ(bench.planner.attempts(), 2);
}

TEST(PickPlanner, HoldsStillWhenTheObjectIsOutOfReach) {
  Bench bench("box", 1.2);
  const Outcome outcome = bench.Run();
  EXPECT_EQ(outcome.failure, "no grasp in reach");
  EXPECT_EQ(bench.planner.attempts(), 0);
  EXPECT_EQ(bench.planner.Act(bench.pick.scene, bench.rng).at("rc7").at("arm").values.size(), 7u);
}

// Uses starts of the sampler, with other objects around: the planner must succeed where the sampler
// accepts.
double SuccessRate(const RunConfig& run, int episodes) {
  StartSampler sampler(run);
  int accepted = 0, successes = 0;
  for (int i = 0; i < episodes; ++i) {
    Rng rng = Rng::Stream(11, i);
    SampleResult sample = sampler.Sample({.episode = i}, rng);
    if (!sample.start) continue;
    ++accepted;
    PickPlanner planner(run.robot.config.name, "target", run.options);
    const Outcome outcome = RollOut(sample.start->scene, *sample.start->task, planner, rng);
    successes += outcome.success;
    if (!outcome.success) std::printf("episode %d: %s\n", i, outcome.failure.c_str());
  }
  EXPECT_GE(accepted, episodes / 2);
  return static_cast<double>(successes) / accepted;
}

TEST(PickPlanner, SucceedsFromTheStartsOfTheDemo) {
  EXPECT_GE(SuccessRate(ExampleRun("demo.yaml"), LongForm() ? 16 : 6), 0.9);
}

TEST(PickPlanner, SucceedsWithARealArmAndALinkageGripper) {
  REQUIRE_MENAGERIE("ufactory_xarm7");
  RunConfig run = ExampleRun("xarm7_pick.yaml");
  run.task.As<PickTaskConfig>().objects = {};  // all kinds
  EXPECT_GE(SuccessRate(run, LongForm() ? 12 : 4), 0.9);
}

}  // namespace
}  // namespace robocell
