// Tests environments whose pick and pick_and_place draw their objects, as runs do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/hook_error.h"
#include "robocell/data/feature_schema.h"
#include "robocell/env/env.h"
#include "robocell/env/env_layout.h"
#include "robocell/env/env_state.h"
#include "robocell/env/testing/envs.h"
#include "robocell/features/cell_features.h"
#include "robocell/task/pick_task_config.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

// The built-in robot on a floor.
EnvConfig OnTheFloor(TaskSpec task) {
  EnvConfig config = Rc7Env();
  config.add_floor = true;
  config.task = std::move(task);
  return config;
}

Eigen::Vector3d At(const Env& env, const std::string& object) {
  return env.scene().body_pose(env.scene().compiled()->object(object).root_body).translation();
}

// Returns a place that the task observes, x y z in the shared base frame.
Eigen::Vector3d Observed(const Env& env, const std::string& name) {
  for (int i = 0; i < env.layout().observation.size(); ++i) {
    if (NameOfObservation(env.layout(), i) != "task." + name + "[0]") continue;
    const auto numbers = env.observation().subspan(i, 3);
    return {numbers[0], numbers[1], numbers[2]};
  }
  ADD_FAILURE() << "no " << name;
  return Eigen::Vector3d::Zero();
}

TEST(DrawnTask, EachResetDrawsPlacesAndTheTargetFromItsSeed) {
  Env env(OnTheFloor(PickTaskConfig{.objects = {"box", "sphere", "nut"}}));
  EXPECT_THAT(env.scene().object_names(),
              UnorderedElementsAre("target_box", "target_sphere", "target_nut"));
  std::set<std::string> instructions;
  std::vector<double> first;
  for (uint64_t seed = 0; seed < 12; ++seed) {
    env.Reset({.seed = seed});
    const std::string words = env.instruction();
    instructions.insert(words);
    const std::string target = "target_" + words.substr(std::string("pick up the ").size());
    const Eigen::Vector3d in_base =
        env.scene().shared_base_frame_to_world().inverse() * At(env, target);
    EXPECT_LT((Observed(env, "target") - in_base).norm(), 1e-6) << words;
    EXPECT_LT(At(env, target).norm(), Robot::Of(env.scene(), "robot").reach());
    const std::vector<double> state = env.scene().state();
    env.Reset({.seed = seed});
    EXPECT_EQ(env.scene().state(), state) << "the same seed, the same start";
    EXPECT_EQ(env.instruction(), words);
    // The engine is the oracle: all objects lie still.
    Scene scene = env.scene();
    std::vector<Eigen::Vector3d> before;
    for (const std::string& object : scene.object_names()) before.push_back(At(env, object));
    EXPECT_TRUE(scene.StepN(200).ok());
    for (size_t i = 0; i < before.size(); ++i)
      EXPECT_LT((At(env, scene.object_names()[i]) - before[i]).norm(), 0.005);
  }
  EXPECT_THAT(instructions,
              UnorderedElementsAre("pick up the box", "pick up the sphere", "pick up the nut"));
}

TEST(DrawnTask, WithoutKindsThreeOfTheCatalogueAreThere) {
  const Env env(OnTheFloor(TaskSpec(PickTaskConfig{})));
  EXPECT_EQ(env.scene().object_names().size(), 3u);
}

TEST(DrawnTask, ASavedStateRemembersItsTarget) {
  Env env(OnTheFloor(PickTaskConfig{.objects = {"box", "sphere", "nut"}}));
  uint64_t seed = 0;
  env.Reset({.seed = seed});
  const std::string words = env.instruction();
  const Eigen::Vector3d target = Observed(env, "target");
  const EnvState saved = env.state();
  while (env.instruction() == words) env.Reset({.seed = ++seed});
  env.SetState(saved);
  EXPECT_EQ(env.instruction(), words);
  EXPECT_LT((Observed(env, "target") - target).norm(), 1e-9);
}

TEST(DrawnTask, RejectsAStateWhoseTargetIsNotThere) {
  PickAndPlaceTaskConfig task;
  task.objects = {"box", "nut"};
  task.goals = {"tray", "nut"};
  Env env(OnTheFloor(task));
  env.Reset({.seed = 0});
  const EnvState saved = env.state();
  const std::string words = env.instruction();
  for (const size_t number : {size_t{3}, saved.task.size() - 1}) {  // the target, the goal
    for (const double wrong : {99.0, 2.0, -1.0, 0.5, 1e300, std::nan("")}) {
      EnvState state = saved;
      state.task[number] = wrong;
      ExpectThrow<ArgumentError>([&] { env.SetState(state); }, "state is of another environment");
    }
  }
  EXPECT_EQ(env.instruction(), words) << "nothing changed";
  EXPECT_NO_THROW(env.SetState(saved));
}

TEST(DrawnTask, PickAndPlaceDrawsAGoalObject) {
  Env env(OnTheFloor(PickAndPlaceTaskConfig{.objects = {"box", "nut"}}));
  EXPECT_THAT(env.scene().object_names(), UnorderedElementsAre("target_box", "target_nut", "goal"));
  for (uint64_t seed = 0; seed < 6; ++seed) {
    env.Reset({.seed = seed});
    EXPECT_THAT(env.instruction(), HasSubstr(" and put it on the tray"));
    const Eigen::Vector3d goal = env.scene().shared_base_frame_to_world() * Observed(env, "goal");
    const Eigen::Vector3d tray = At(env, "goal");
    EXPECT_LT((goal - tray).head<2>().norm(), 0.02) << "in the middle of the tray";
    const Eigen::Vector3d target =
        env.scene().shared_base_frame_to_world() * Observed(env, "target");
    EXPECT_GE((goal - target).head<2>().norm(), 0.1 - 1e-6) << "goal_distance";
  }
}

// The same `task` has the same columns in a run, whose object is the target of that start.
TEST(DrawnTask, ASingleKindIsObservedAsInARun) {
  Env env(OnTheFloor(PickTaskConfig{.objects = {"cylinder"}}));
  env.Reset({.seed = 1});
  EXPECT_THAT(env.scene().object_names(), UnorderedElementsAre("target"));
  EXPECT_EQ(env.instruction(), "pick up the cylinder");
  const FeatureSchema schema = env.features().schema();
  std::vector<std::string> names;
  for (const Feature& feature : schema.features()) names.push_back(feature.column.name);
  EXPECT_THAT(names, ::testing::Contains("objects/target/pose"));
  EXPECT_THAT(names, ::testing::Not(::testing::Contains("task/target")));
}

// A named goal with drawn objects, and a named object with a drawn goal.
TEST(DrawnTask, ObjectAndGoalMayBeNamedOneByOne) {
  PickAndPlaceTaskConfig task{.goal = Vec3{0.35, 0.25, 0.03}};
  task.objects = {"box"};
  Env to_place(OnTheFloor(task));
  EXPECT_THAT(to_place.scene().object_names(), UnorderedElementsAre("target"));
  to_place.Reset({.seed = 1});
  const Eigen::Vector3d goal = Observed(to_place, "goal");
  EXPECT_LT((goal - Eigen::Vector3d(0.35, 0.25, 0.03)).norm(), 1e-6);

  EnvConfig config = OnTheFloor(PickAndPlaceTaskConfig{.object = "cube"});
  config.root_frame_objects["cube"] = {.offset = Pose(Eigen::Vector3d(0.4, 0, 0.02)),
                                       .shape = Shape::kBox,
                                       .size = Vec3{0.02, 0.02, 0.02},
                                       .mass = 0.05};
  Env on_tray(config);
  EXPECT_THAT(on_tray.scene().object_names(), UnorderedElementsAre("cube", "goal"));
  on_tray.Reset({.seed = 1});
  EXPECT_EQ(on_tray.instruction(), "pick up the cube and put it on the tray");
  EXPECT_LT((At(on_tray, "cube") - Eigen::Vector3d(0.4, 0, 0.02)).norm(), 1e-3);
}

TEST(DrawnTask, ObjectsOfTheRigKeepTheirNames) {
  EnvConfig config = OnTheFloor(PickTaskConfig{.objects = {"box"}});
  config.root_frame_objects["target"] = {.offset = Pose(Eigen::Vector3d(0.4, 0, 0.02)),
                                         .shape = Shape::kBox,
                                         .size = Vec3{0.02, 0.02, 0.02},
                                         .mass = 0.05};
  ExpectThrow<HookError>([&] { const Env env(config); }, "object 'target', a name that scene");
}

// Each object may become the target, so that the goal has to fit all of them.
TEST(DrawnTask, RejectsAGoalAtWhichAnObjectCannotRest) {
  const auto placing = [](double height, const std::vector<std::string>& objects) {
    PickAndPlaceTaskConfig task{.goal = Vec3{0.35, 0.25, height}, .goal_tolerance = 0.02};
    task.objects.names = objects;
    return OnTheFloor(task);
  };
  const std::string text = ExpectThrow<HookError>(
      [&] {
        const Env env(placing(0.3, {"box", "mug"}));
      },
      "'target_box' cannot come to rest at task.goal [0.35, 0.25, 0.3]: put down there it falls "
      "by");
  EXPECT_THAT(text, HasSubstr("which fits the height of each kind of task.objects"));
  EXPECT_NO_THROW(Env{placing(0.03, {"box"})});
  ExpectThrow<HookError>(
      [&] {
        const Env env(placing(0.07, {"bottle", "nut"}));
      },
      "'target_nut' cannot come to rest");
}

TEST(DrawnTask, AGoalThatIsALittleTooLowSaysHowHighItHasToBe) {
  PickAndPlaceTaskConfig task{.goal = Vec3{0.35, 0.25, 0.02}};
  task.objects = {"bottle"};
  ExpectThrow<SpecError>([&] { const Env env(OnTheFloor(task)); },
                         "task.goal is where the root of the object comes to rest: it is 0.020 m "
                         "over what is under it, and the root of 'target");
}

// As in a run: an entry by kind is about the drawn object of that kind.
TEST(DrawnTask, PlacesMayNameObjectsByTheirKinds) {
  EnvConfig config = OnTheFloor(PickTaskConfig{.objects = {"box", "nut", "bottle"}});
  config.places = {{"nut", {.next_to = "box"}}};
  Env env(config);
  const auto distance = [&] {
    return (At(env, "target_nut") - At(env, "target_box")).head<2>().norm();
  };
  for (uint64_t seed = 0; seed < 4; ++seed) {
    env.Reset({.seed = seed});
    EXPECT_LT(distance(), 0.2) << seed;
  }
  config.places = {{"sphere", {.next_to = "box"}}};
  ExpectThrow<SpecError>([&] { const Env other(config); }, "places.sphere: no object 'sphere'");
}

}  // namespace
}  // namespace robocell
