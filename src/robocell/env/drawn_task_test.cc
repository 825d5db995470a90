// Tests environments whose pick and pick_and_place draw their objects, as runs do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <span>
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

// Returns an observed place, x y z in the shared base frame.
Eigen::Vector3d Place(const Env& env, const std::string& path) {
  for (int i = 0; i < env.layout().observation.size(); ++i) {
    if (NameOfObservation(env.layout(), i) != path + "[0]") continue;
    const auto numbers = env.observation().subspan(i, 3);
    return {numbers[0], numbers[1], numbers[2]};
  }
  ADD_FAILURE() << "no " << path;
  return Eigen::Vector3d::Zero();
}

Eigen::Vector3d Observed(const Env& env, const std::string& object) {
  return Place(env, "objects." + object + ".tquat");
}

std::vector<std::string> ColumnsOf(Env& env) {
  std::vector<std::string> names;
  for (const Feature& feature : env.features().observed().features())
    names.push_back(feature.column.name);
  return names;
}

// Returns the place in a pose column of the row that would be recorded now.
Eigen::Vector3d Recorded(Env& env, const std::string& column) {
  std::span<const double> rest = env.features().ReadState();
  for (const Feature& feature : env.features().observed().features()) {
    if (feature.column.name == column) return {rest[0], rest[1], rest[2]};
    rest = rest.subspan(static_cast<size_t>(feature.size()));
  }
  ADD_FAILURE() << "no " << column;
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

// A run observes the drawn objects by the same names, whichever body stands for them.
TEST(DrawnTask, TargetAndGoalAreObservedByTheirPartsWhateverIsDrawn) {
  PickAndPlaceTaskConfig task;
  task.objects = {"mug", "nut"};
  task.goals = {"tray", "box"};
  Env env(OnTheFloor(task));
  EXPECT_THAT(ColumnsOf(env),
              ::testing::IsSupersetOf({"objects/target/pose", "objects/goal/pose",
                                       "robots/robot/objects/target/pose_in_tcp",
                                       "robots/robot/objects/goal/pose_in_tcp", "task/goal"}));
  EXPECT_THAT(ColumnsOf(env), ::testing::Not(::testing::Contains("objects/target_mug/pose")));
  EXPECT_THAT(ColumnsOf(env), ::testing::Not(::testing::Contains("task/target")));
  std::set<std::string> instructions;
  for (uint64_t seed = 0; seed < 12; ++seed) {
    env.Reset({.seed = seed});
    const std::string words = env.instruction();
    instructions.insert(words);
    const bool is_mug = words.find("mug") != std::string::npos;
    const Eigen::Vector3d target = At(env, is_mug ? "target_mug" : "target_nut");
    const bool on_tray = words.find("tray") != std::string::npos;
    const Eigen::Vector3d goal = At(env, on_tray ? "goal_tray" : "goal_box");
    EXPECT_LT((Recorded(env, "objects/target/pose") - target).norm(), 1e-12) << words;
    EXPECT_LT((Recorded(env, "objects/goal/pose") - goal).norm(), 1e-12) << words;
    const Pose tcp = Robot::Of(env.scene(), "robot").tcp_in_world();
    EXPECT_LT((tcp * Recorded(env, "robots/robot/objects/target/pose_in_tcp") - target).norm(),
              1e-9);
    const Pose base = env.scene().shared_base_frame_to_world();
    EXPECT_LT((base * Observed(env, "target") - target).norm(), 1e-6);
    EXPECT_LT((base * Observed(env, "goal") - goal).norm(), 1e-6);
    EXPECT_EQ(env.task()->kind_of("target"), is_mug ? "mug" : "nut");
    const Eigen::Vector3d other = At(env, is_mug ? "target_nut" : "target_mug");
    EXPECT_LT((Recorded(env, "objects/object_1/pose") - other).norm(), 1e-12) << words;
  }
  EXPECT_THAT(env.task()->objects(), ::testing::ElementsAre("target", "goal", "object_1"));
  EXPECT_EQ(instructions.size(), 4u) << "both of each were drawn";
}

TEST(DrawnTask, ObjectsAreAlsoObservedByTheirNamesInTheScene) {
  EnvConfig config = OnTheFloor(PickTaskConfig{.objects = {"box", "nut"}});
  config.features = {"objects/target_nut/pose"};
  Env env(config);
  env.Reset({.seed = 1});
  const Eigen::Vector3d nut = Place(env, "features.objects/target_nut/pose");
  EXPECT_LT((nut - At(env, "target_nut")).norm(), 1e-6);
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
      ExpectThrow<ArgumentError>([&] { env.SetState(state); },
                                 "the memory of task 'pick_and_place' in the state: number " +
                                     std::to_string(number) + ", which object is the " +
                                     (number == 3 ? "target" : "goal"));
    }
  }
  EXPECT_EQ(env.instruction(), words) << "nothing changed";
  EnvState nowhere = saved;
  nowhere.task[5] = std::nan("");
  ExpectThrow<ArgumentError>([&] { env.SetState(nowhere); }, "number 5, of the goal, is nan");
  EXPECT_NO_THROW(env.SetState(saved));
}

TEST(DrawnTask, PickAndPlaceDrawsAGoalObject) {
  Env env(OnTheFloor(PickAndPlaceTaskConfig{.objects = {"box", "nut"}}));
  EXPECT_THAT(env.scene().object_names(), UnorderedElementsAre("target_box", "target_nut", "goal"));
  for (uint64_t seed = 0; seed < 6; ++seed) {
    env.Reset({.seed = seed});
    EXPECT_THAT(env.instruction(), HasSubstr(" and put it on the tray"));
    const Eigen::Vector3d goal = env.scene().shared_base_frame_to_world() * Place(env, "task.goal");
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
  const Eigen::Vector3d goal = Place(to_place, "task.goal");
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

TEST(DrawnTask, RejectsAnObjectOfTheRigWithTheNameOfADrawnOne) {
  EnvConfig config = OnTheFloor(PickTaskConfig{.objects = {"box"}});
  config.root_frame_objects["target"] = {.offset = Pose(Eigen::Vector3d(0.4, 0, 0.02)),
                                         .shape = Shape::kBox,
                                         .size = Vec3{0.02, 0.02, 0.02},
                                         .mass = 0.05};
  ExpectThrow<SpecError>([&] { const Env env(config); },
                         "root_frame_objects.target: task 'pick' gives this name to an object that "
                         "it draws; choose another name, or let the task use this object: "
                         "task.object: target");
  const EnvObject block = config.root_frame_objects["target"];
  config = OnTheFloor(PickTaskConfig{.objects = {"box"}});
  config.root_frame_objects["target_cup"] = block;
  EXPECT_NO_THROW(Env{config});
  config = OnTheFloor(PickAndPlaceTaskConfig{});
  config.world_frame_objects["goal_tray"] = block;
  ExpectThrow<SpecError>([&] { const Env env(config); },
                         "world_frame_objects.goal_tray: task 'pick_and_place' gives this name");
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

// An entry by kind places the drawn object of that kind, as in a run.
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
  // The entry of the target is about another object in each start.
  config.places = {{"target", {.next_to = "box"}}};
  Env other(config);
  std::set<std::string> instructions;
  for (uint64_t seed = 0; seed < 8; ++seed) {
    other.Reset({.seed = seed});
    const Eigen::Vector3d box = At(other, "target_box");
    const std::string target = other.task()->object_of("target");
    instructions.insert(target);
    EXPECT_LT((At(other, target) - box).head<2>().norm(), 0.2) << seed;
  }
  EXPECT_THAT(instructions, UnorderedElementsAre("target_nut", "target_bottle"))
      << "there is one box";
  config.places = {{"target", {.next_to = "shpere"}}};
  ExpectThrow<SpecError>([&] { const Env wrong(config); },
                         "places.target: no object or body 'shpere'");
  config.places = {{"sphere", {.next_to = "box"}}};
  ExpectThrow<SpecError>([&] { const Env wrong(config); }, "places.sphere: no object 'sphere'");
}

}  // namespace
}  // namespace robocell
