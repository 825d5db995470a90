#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <limits>

#include "robocell/assets/resolve.h"
#include "robocell/base/error.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/scene/testing/workplace.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

TEST(SceneFrames, MovesFreeBodiesAndStopsThem) {
  Scene scene = Scene::Build(Workplace());
  scene.SetBodyWrench("cube", {0, 0, 5}, {0, 0, 0});
  EXPECT_TRUE(scene.StepN(50).ok());
  scene.SetBodyPose("cube", Pose::FromRpy({1, 2, 3}, {0.1, 0.2, 0.3}));
  EXPECT_TRUE(
      scene.body_pose("cube").is_close(Pose::FromRpy({1, 2, 3}, {0.1, 0.2, 0.3}), 1e-12, 1e-12));
  const int dof =
      scene.model()->jnt_dofadr[RequireId(scene.model(), mjOBJ_JOINT, "cube_joint", "")];
  for (int i = 0; i < 6; ++i) EXPECT_EQ(scene.data()->qvel[dof + i], 0);
  ExpectThrow<ArgumentError>([&] { scene.SetBodyPose("link3", Pose()); },
                             "scene 'test': body 'link3' cannot be moved by its pose: it is "
                             "neither free nor a mocap body");
}

TEST(SceneFrames, AWrenchActsUntilItIsChanged) {
  Scene scene = Scene::Build(Workplace());
  scene.SetBodyWrench("cube", {0, 0, 0.1 * 9.81 + 0.1}, {0, 0, 0});
  EXPECT_TRUE(scene.StepN(500).ok());  // one second with 1 m/s^2
  EXPECT_NEAR(scene.body_pose("cube").translation().z() - 0.02, 0.5, 0.01);
}

TEST(SceneFrames, ActuatorsAreReadAndSetByName) {
  Scene scene = Scene::Build(Workplace());
  EXPECT_TRUE(scene.has_actuator("servo2"));
  EXPECT_FALSE(scene.has_actuator("finger"));
  scene.SetActuatorCtrl("servo2", 0.25);
  EXPECT_EQ(scene.actuator_ctrl("servo2"), 0.25);
  const int actuator = RequireId(scene.model(), mjOBJ_ACTUATOR, "servo2", "test");
  EXPECT_EQ(scene.data()->ctrl[scene.model()->actuator_ctrladr[actuator]], 0.25);
  ExpectThrow<NotFoundError>([&] { scene.actuator_ctrl("servo22"); },
                             "scene 'test': no actuator 'servo22'.");
  ExpectThrow<NotFoundError>([&] { scene.SetActuatorCtrl("srvo2", 0); }, "Did you mean 'servo2'?");
}

TEST(SceneFrames, JointsAreReadByName) {
  Scene scene = Scene::Build(Workplace());
  const int joint = RequireId(scene.model(), mjOBJ_JOINT, "joint2", "test");
  scene.data()->qpos[scene.model()->jnt_qposadr[joint]] = 0.375;
  EXPECT_EQ(scene.joint_pos("joint2"), 0.375);
  ExpectThrow<NotFoundError>([&] { (void)scene.joint_pos("joint22"); },
                             "scene 'test': no joint 'joint22'.");
  ExpectThrow<ArgumentError>([&] { (void)scene.joint_pos("cube_joint"); },
                             "scene 'test': joint 'cube_joint' is free, whose position is more "
                             "than one number; ask for the pose of its body, body_pose(\"cube\")");
}

TEST(SceneFrames, RejectsNonFiniteNumbers) {
  Scene scene = Scene::Build(Workplace());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  ExpectThrow<ArgumentError>(
      [&] { scene.SetActuatorCtrl("servo2", nan); },
      "scene 'test': control of actuator 'servo2' must be a finite number, got nan");
  ExpectThrow<ArgumentError>(
      [&] {
        scene.SetBodyWrench("cube", {0, nan, 0}, {0, 0, 0});
      },
      "force on body 'cube' must be a finite number");
}

TEST(SceneFrames, RejectsAWrenchOnTheWorld) {
  Scene scene = Scene::Build(Workplace());
  ExpectThrow<ArgumentError>(
      [&] {
        scene.SetBodyWrench("world", {1, 0, 0});
      },
      "scene 'test': body 'world' cannot be pushed, because it cannot move. Name another body: ");
}

TEST(SceneFrames, ContinuesBitwiseFromASavedState) {
  Scene scene = Scene::Build(Workplace());
  scene.SetActuatorCtrl("servo1", 0.5);
  EXPECT_TRUE(scene.StepN(123).ok());
  const std::vector<double> saved = scene.state();
  EXPECT_TRUE(scene.StepN(77).ok());
  const std::vector<double> expected = scene.state();
  scene.Reset({.seed = 1});
  scene.SetState(saved);
  EXPECT_EQ(scene.state(), saved);
  EXPECT_TRUE(scene.StepN(77).ok());
  EXPECT_EQ(scene.state(), expected);
  ExpectThrow<ArgumentError>([&] { scene.SetState(std::vector<double>(3)); },
                             "numbers, got 3; states fit only the model they were taken from");
}

int AsleepIn(const Scene& scene) {
  const int* trees = scene.data()->tree_asleep;
  return static_cast<int>(
      std::count_if(trees, trees + scene.model()->ntree, [](int tree) { return tree >= 0; }));
}

// A state does not say which bodies sleep.
TEST(SceneFrames, WhatSleptBeforeAStateWasSetDoesNotMatter) {
  SceneSpec spec = Workplace();
  spec.options.enable = {"sleep"};
  Scene rested = Scene::Build(spec), fresh = Scene::Build(spec);
  EXPECT_TRUE(rested.StepN(1000).ok());
  ASSERT_GT(AsleepIn(rested), 0);
  const std::vector<double> state = rested.state();
  for (Scene* scene : {&rested, &fresh}) {
    scene->SetState(state);
    EXPECT_EQ(AsleepIn(*scene), 0);
    EXPECT_EQ(scene->state(), state);
    EXPECT_TRUE(scene->StepN(300).ok());
    scene->SetBodyWrench("cube", {0.3, 0, 0});
    EXPECT_TRUE(scene->StepN(200).ok());
  }
  EXPECT_EQ(rested.state(), fresh.state());
}

TEST(SceneFrames, RejectsNonFiniteStates) {
  Scene scene = Scene::Build(Workplace());
  const mjModel* m = scene.model();
  const std::vector<double> before = scene.state();
  const auto refuses = [&](int part, int index, const std::string& what) {
    const auto at = static_cast<size_t>(mj_stateSize(m, part - 1) + index);  // after previous parts
    std::vector<double> state = before;
    for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
      state[at] = bad;
      ExpectThrow<ArgumentError>(
          [&] { scene.SetState(state); },
          fmt::format("number {} of the state is {}: {}; all of a state is finite", at, bad, what));
      EXPECT_EQ(scene.state(), before);
    }
  };
  const int last_joint = static_cast<int>(m->njnt) - 1;
  const std::string first = Describe(m, mjOBJ_JOINT, 0);
  refuses(mjSTATE_TIME, 0, "the time");
  refuses(mjSTATE_QPOS, 0, "the position of " + first);
  refuses(mjSTATE_QPOS, static_cast<int>(m->nq) - 1,
          "the position of " + Describe(m, mjOBJ_JOINT, last_joint));
  refuses(mjSTATE_QVEL, 0, "the velocity of " + first);
  refuses(mjSTATE_WARMSTART, 0, "the warm start of " + first);
  refuses(mjSTATE_CTRL, m->actuator_ctrladr[m->nactuator - 1],
          "the control of " + Describe(m, mjOBJ_ACTUATOR, static_cast<int>(m->nactuator) - 1));
  refuses(mjSTATE_QFRC_APPLIED, 0, "the applied force of " + first);
  refuses(mjSTATE_XFRC_APPLIED, 8, "the wrench on " + Describe(m, mjOBJ_BODY, 1));
}

TEST(SceneFrames, ExplainsTheControlsOfAMultiInputActuator) {
  ModelFolder folder;
  SceneSpec spec = EmptyScene();
  spec.robots.push_back({.path = folder.Write("arm", TwoJointArmWithABall())});
  Scene scene = Scene::Build(spec);
  const std::string why =
      "scene 'test': actuator 'turn' has 3 controls, not one: ctrl[0] to ctrl[2], in the order of "
      "its inputs. Read and write them as data()->ctrl (in Python scene.data.ctrl[0:3])";
  ExpectThrow<ArgumentError>([&] { scene.SetActuatorCtrl("turn", 0.3); }, why);
  ExpectThrow<ArgumentError>([&] { scene.actuator_ctrl("turn"); }, why);
  scene.SetActuatorCtrl("servo1", 0.3);
  EXPECT_EQ(scene.data()->ctrl[3], 0.3);
  EXPECT_EQ(scene.actuator_ctrl("servo1"), 0.3);
}

}  // namespace
}  // namespace robocell
