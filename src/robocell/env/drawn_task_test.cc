// Tests environments whose pick and pick_and_place draw their objects, as runs do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "robocell/base/hook_error.h"
#include "robocell/env/env.h"
#include "robocell/env/env_layout.h"
#include "robocell/env/env_state.h"
#include "robocell/env/testing/envs.h"
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

TEST(DrawnTask, PickAndPlaceDrawsAGoalObject) {
  Env env(OnTheFloor(PickAndPlaceTaskConfig{.objects = {"box", "nut"}}));
  EXPECT_THAT(env.scene().object_names(),
              UnorderedElementsAre("target_box", "target_nut", "goal_tray"));
  for (uint64_t seed = 0; seed < 6; ++seed) {
    env.Reset({.seed = seed});
    EXPECT_THAT(env.instruction(), HasSubstr(" and put it on the tray"));
    const Eigen::Vector3d goal = env.scene().shared_base_frame_to_world() * Observed(env, "goal");
    const Eigen::Vector3d tray = At(env, "goal_tray");
    EXPECT_LT((goal - tray).head<2>().norm(), 0.02) << "in the middle of the tray";
    const Eigen::Vector3d target =
        env.scene().shared_base_frame_to_world() * Observed(env, "target");
    EXPECT_GE((goal - target).head<2>().norm(), 0.1 - 1e-6) << "goal_distance";
  }
}

// A named goal with drawn objects, and a named object with a drawn goal.
TEST(DrawnTask, ObjectAndGoalMayBeNamedOneByOne) {
  PickAndPlaceTaskConfig task{.goal = Vec3{0.35, 0.25, 0.03}};
  task.objects = {"box"};
  Env to_place(OnTheFloor(task));
  EXPECT_THAT(to_place.scene().object_names(), UnorderedElementsAre("target_box"));
  to_place.Reset({.seed = 1});
  const Eigen::Vector3d goal = Observed(to_place, "goal");
  EXPECT_LT((goal - Eigen::Vector3d(0.35, 0.25, 0.03)).norm(), 1e-6);

  EnvConfig config = OnTheFloor(PickAndPlaceTaskConfig{.object = "cube"});
  config.root_frame_objects["cube"] = {.offset = Pose(Eigen::Vector3d(0.4, 0, 0.02)),
                                       .shape = Shape::kBox,
                                       .size = Vec3{0.02, 0.02, 0.02},
                                       .mass = 0.05};
  Env on_tray(config);
  EXPECT_THAT(on_tray.scene().object_names(), UnorderedElementsAre("cube", "goal_tray"));
  on_tray.Reset({.seed = 1});
  EXPECT_EQ(on_tray.instruction(), "pick up the cube and put it on the tray");
  EXPECT_LT((At(on_tray, "cube") - Eigen::Vector3d(0.4, 0, 0.02)).norm(), 1e-3);
}

TEST(DrawnTask, ObjectsOfTheRigKeepTheirNames) {
  EnvConfig config = OnTheFloor(PickTaskConfig{.objects = {"box"}});
  config.root_frame_objects["target_box"] = {.offset = Pose(Eigen::Vector3d(0.4, 0, 0.02)),
                                             .shape = Shape::kBox,
                                             .size = Vec3{0.02, 0.02, 0.02},
                                             .mass = 0.05};
  ExpectThrow<HookError>([&] { const Env env(config); }, "object 'target_box', a name that scene");
}

}  // namespace
}  // namespace robocell
