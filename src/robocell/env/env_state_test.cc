// Tests states of environments as values, scenes from saved files, and objects that vary.
#include "robocell/env/env_state.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "robocell/base/error.h"
#include "robocell/base/rng.h"
#include "robocell/base/units.h"
#include "robocell/env/arm_target.h"
#include "robocell/env/env.h"
#include "robocell/env/env_scene.h"
#include "robocell/env/testing/envs.h"
#include "robocell/mujoco/names.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

const Pose kElsewhere = Pose::FromRpy({1, -1, 0.3}, {0, 0, 2});

std::vector<double> Seen(const Env& env) {
  return {env.observation().begin(), env.observation().end()};
}

EnvStep GoTo(Env& env, const Eigen::Vector3d& tcp, double gripper) {
  std::vector<double> action(8);
  internal::PutTquat(Pose::FromRpy(tcp, {internal::kPi, 0, 0}), action);
  action[7] = gripper;
  return env.Step(action);
}

Pose CubeInRoot(const Env& env) {
  return env.scene().root_frame_to_world().inverse() * env.scene().body_pose("cube");
}

// The cube turns and flies, and the arm is moving.
void Stir(Env& env) {
  GoTo(env, {0.4, 0.1, 0.3}, 0);
  const mjModel* m = env.scene().model();
  const int dof = m->body_dofadr[RequireId(m, mjOBJ_BODY, "cube", "test")];
  const Eigen::Vector3d up =
      env.scene().root_frame_to_world().rotation() * Eigen::Vector3d(0.2, 0.1, 2);
  std::copy_n(up.data(), 3, env.scene().data()->qvel + dof);
  env.scene().data()->qvel[dof + 3] = 3;
}

TEST(EnvStates, ContinueBitwiseInAnotherEnvironmentAndFromNumbers) {
  Env env(Rc7WithCube());
  env.Reset({.seed = 3});
  Stir(env);
  const EnvState state = env.state();
  EXPECT_EQ(EnvState::FromNumbers(state.numbers()).numbers(), state.numbers());
  GoTo(env, {0.45, 0, 0.2}, 1);
  Env other(Rc7WithCube());
  other.SetState(EnvState::FromNumbers(state.numbers()));
  EXPECT_EQ(other.state().numbers(), state.numbers());
  GoTo(other, {0.45, 0, 0.2}, 1);
  EXPECT_EQ(Seen(other), Seen(env));
}

// The oracle is an environment that was at the second place from the beginning: only gravity, which
// both have along their z, and the rig's own frame matter.
TEST(EnvStates, InTheRootFrameContinueAtAnyRootPose) {
  Env here(Rc7WithCube()), there(Rc7WithCube(kElsewhere));
  here.Reset({.seed = 3});
  Stir(here);
  there.SetState(here.state(), StateFrame::kRoot);
  EXPECT_TRUE(CubeInRoot(there).is_close(CubeInRoot(here), 1e-9, 1e-9));
  for (int i = 0; i < 3; ++i) {
    const EnvStep a = GoTo(here, {0.4, 0.1, 0.3}, 0), b = GoTo(there, {0.4, 0.1, 0.3}, 0);
    EXPECT_NEAR(a.reward, b.reward, 1e-6);
    EXPECT_TRUE(CubeInRoot(there).is_close(CubeInRoot(here), 1e-5, 1e-5)) << i;
  }
  there.SetState(here.state());
  EXPECT_TRUE(
      there.scene().body_pose("cube").is_close(here.scene().body_pose("cube"), 1e-12, 1e-12))
      << "raw states are of the world";
}

TEST(EnvStates, RequireTheSameConfiguration) {
  Env env(Rc7WithCube());
  ExpectThrow<Error>([&] { env.state(); }, "call reset before the first step");
  env.Reset();
  EnvConfig without = Rc7WithCube();
  without.task.reset();
  Env other(without);
  ExpectThrow<ArgumentError>([&] { other.SetState(env.state()); },
                             "environment 'env': the state is of another environment; states fit "
                             "those of the same configuration, but for root_frame_to_world");
  std::vector<double> numbers = env.state().numbers();
  numbers.pop_back();
  ExpectThrow<ArgumentError>([&] { EnvState::FromNumbers(numbers); },
                             "not a state of an environment");
}

// A controller's target can be a sum of steps, which is restored to the bit all the same.
TEST(EnvStates, OfARelativeControllerContinueBitwise) {
  for (const ControlMode mode : {ControlMode::kJoints, ControlMode::kCartesianTrpy}) {
    EnvConfig config = Rc7Env(mode);
    config.robots["robot"].control["arm"] = ControlKind::kRelativeJointPosition;
    Env env(config), other(config);
    env.Reset({.seed = 3});
    other.Reset({.seed = 4});
    Rng rng = Rng::Stream(5, "relative joint positions");
    const auto action = [&] {
      std::vector<double> numbers(static_cast<size_t>(env.layout().action.size()));
      for (double& x : numbers) x = 0.02 * rng.Uniform(-1, 1);
      return numbers;
    };
    for (int trial = 0; trial < 20; ++trial) {
      env.Step(action());
      const EnvState state = env.state();
      const std::vector<double> next = action();
      env.Step(next);
      other.SetState(state);
      EXPECT_EQ(other.state().numbers(), state.numbers()) << trial;
      other.Step(next);
      ASSERT_EQ(Seen(other), Seen(env)) << trial;
      ASSERT_EQ(other.state().numbers(), env.state().numbers()) << trial;
    }
  }
}

TEST(EnvStates, RejectNumbersThatTheEngineRejects) {
  Env env(Rc7WithCube());
  env.Reset();
  EnvState state = env.state();
  for (std::vector<double> ArmMemory::*joints :
       {&ArmMemory::commanded, &ArmMemory::sent_joints, &ArmMemory::origin_joints}) {
    EnvState other = state;
    (other.arms[0].*joints)[2] = -1e300;
    ExpectThrow<ArgumentError>([&] { env.SetState(other); },
                               "of the state is -1e+300; in a state numbers are finite and at "
                               "most 1e+10, what the engine accepts");
  }
  EnvState other = state;
  other.root_frame_to_world = Pose(Eigen::Vector3d(1e11, 0, 0));
  ExpectThrow<ArgumentError>([&] { env.SetState(other); }, "number 0 of the state is");
  env.SetState(state);
}

std::string FileText(const std::string& path) {
  std::ifstream in(path);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

TEST(EnvSavedScenes, ReplaceTheSceneOfTheConfiguration) {
  TempDir folder;
  EnvConfig config = Rc7WithCube();
  const std::string file = folder.path() / "cell.xml";
  Env env(config);
  env.Reset({.seed = 1});
  env.scene().SaveXml(file);

  config.source_dir = folder.path();
  config.saved_scene = "cell.xml";
  Env saved(config);
  saved.Reset({.seed = 1});
  for (size_t i = 0; i < Seen(env).size(); ++i)
    EXPECT_NEAR(Seen(saved)[i], Seen(env)[i], 1e-5) << i;
  GoTo(env, {0.45, 0, 0.2}, 0);
  GoTo(saved, {0.45, 0, 0.2}, 0);
  EXPECT_NEAR(Seen(saved)[2], Seen(env)[2], 1e-3) << "it can be moved";

  std::string text = FileText(file);
  text.replace(text.find("mass=\"0.05\""), 11, "mass=\"0.25\"");
  std::ofstream(file) << text;
  Env changed(config);
  const mjModel* m = changed.scene().model();
  EXPECT_NEAR(m->body_mass[RequireId(m, mjOBJ_BODY, "cube", "test")], 0.25, 1e-9);
}

TEST(EnvSavedScenes, HaveTheElementsOfTheConfiguration) {
  TempDir folder;
  EnvConfig config = Rc7WithCube();
  config.saved_scene = folder.path() / "cell.xml";
  ExpectThrow<IoError>([&] { Env env(config); }, "cell.xml");
  Scene::Build(EnvSceneSpec(config)).SaveXml(config.saved_scene);
  config.root_frame_objects["ball"] = {
      .shape = Shape::kSphere, .size = Vec3{0.02, 0, 0}, .mass = 1};
  ExpectThrow<NotFoundError>([&] { Env env(config); },
                             "has no body 'ball', which the scene of this spec has. Save the scene "
                             "of the same configuration, and keep the names of its elements");
}

EnvConfig Varied() {
  EnvConfig config = Rc7WithCube();
  config.variations["cube"] = {.mass = {0.5, 2}, .friction = {0.8, 1.2}, .colour = 0.2};
  return config;
}

double CubeMass(const Env& env) {
  const mjModel* m = env.scene().model();
  return m->body_mass[RequireId(m, mjOBJ_BODY, "cube", "test")];
}

TEST(EnvVariations, AreDrawnAtEachResetFromItsSeed) {
  Env env(Varied()), other(Varied());
  std::vector<double> masses;
  for (int i = 0; i < 8; ++i) {
    env.Reset(i == 0 ? EnvResetOptions{.seed = 2} : EnvResetOptions{});
    other.Reset(i == 0 ? EnvResetOptions{.seed = 2} : EnvResetOptions{});
    masses.push_back(CubeMass(env));
    EXPECT_EQ(CubeMass(other), masses.back());
    EXPECT_GE(masses.back(), 0.025);
    EXPECT_LE(masses.back(), 0.1);
    const mjModel* m = env.scene().model();
    const int geom = RequireId(m, mjOBJ_GEOM, "cube_geom", "test");
    EXPECT_NEAR(m->geom_rgba[4 * geom], 0.8, 0.2 + 1e-6);
    EXPECT_NE(m->geom_rgba[4 * geom], 0.8f);
    EXPECT_NEAR(m->geom_friction[3 * geom], 1, 0.2 + 1e-9);
  }
  EXPECT_LT(*std::min_element(masses.begin(), masses.end()), 0.05);
  EXPECT_GT(*std::max_element(masses.begin(), masses.end()), 0.06);
}

// The oracle is a model that was compiled with that mass.
TEST(EnvVariations, MatchAModelCompiledWithThem) {
  Env env(Varied());
  env.Reset({.seed = 2});
  EnvConfig config = Rc7WithCube();
  config.root_frame_objects["cube"].mass = CubeMass(env);
  const mjModel* m = env.scene().model();
  const Env made(config);
  const mjModel* oracle = made.scene().model();
  const int cube = RequireId(m, mjOBJ_BODY, "cube", "test");
  const int dof = m->body_dofadr[cube];
  for (int k = 0; k < 3; ++k)
    EXPECT_NEAR(m->body_inertia[3 * cube + k], oracle->body_inertia[3 * cube + k], 1e-12);
  for (int k = 0; k < 6; ++k)
    EXPECT_NEAR(m->dof_invweight0[dof + k] / oracle->dof_invweight0[dof + k], 1, 1e-9);
  EXPECT_NEAR(m->body_subtreemass[0], oracle->body_subtreemass[0], 1e-9);
  EXPECT_EQ(m->stat.extent, oracle->stat.extent);
}

TEST(EnvVariations, ArePartOfAState) {
  Env env(Varied());
  env.Reset({.seed = 2});
  env.Save("start");
  const double mass = CubeMass(env);
  Stir(env);
  const std::vector<double> then = Seen(env);
  env.Reset();
  EXPECT_NE(CubeMass(env), mass);
  env.Restore("start");
  EXPECT_EQ(CubeMass(env), mass);
  Stir(env);
  EXPECT_EQ(Seen(env), then);
}

}  // namespace
}  // namespace robocell
