// `randomize:` in environments: drawn at each reset from its seed, part of the state, never piling up.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cstddef>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/env/env.h"
#include "robocell/env/env_batch.h"
#include "robocell/env/env_scene.h"
#include "robocell/env/testing/envs.h"
#include "robocell/mujoco/names.h"
#include "robocell/spec/yaml.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

EnvConfig Randomized(const std::string& block) {
  EnvConfig config = Rc7WithCube();
  config.randomize = FromYamlUnchecked<RandomizeConfig>(block);
  return config;
}

constexpr const char* kAll =
    "lights: {number: {choice: [1, 2]}}\n"
    "appearance: {objects: {colour: {uniform: [0, 1]}, texture: [marble, checker]}}\n"
    "dynamics: {cube: {mass: {scale: {uniform: [0.5, 2]}}}, robots: {damping: {scale: {uniform: "
    "[0.8, 1.2]}}, gain: {scale: {uniform: [0.9, 1.1]}}}}\n";

std::vector<std::byte> BytesOf(const mjModel* m) {
  const auto* buffer = static_cast<const std::byte*>(m->buffer);
  return {buffer, buffer + m->nbuffer};
}

TEST(EnvRandomize, ASeedGivesItsModelAgainAndTheEndGivesTheSceneItsOwnBack) {
  const EnvConfig config = Randomized(kAll);
  Scene scene = Scene::FromCompiled(CompileEnvScene(config));
  const std::vector<std::byte> own = BytesOf(scene.model());
  {
    Env env(config, scene);
    env.Reset({.seed = 1});
    const std::vector<std::byte> first = BytesOf(scene.model());
    const RandomizedValues values = env.randomized();
    EXPECT_TRUE(values.contains("cube/mass_scale"));
    EXPECT_TRUE(values.contains("robot/gain_scale"));
    EXPECT_NE(first, own);
    env.Reset({.seed = 2});
    EXPECT_NE(BytesOf(scene.model()), first);
    env.Reset({.seed = 1});
    EXPECT_EQ(BytesOf(scene.model()), first);
    EXPECT_EQ(env.randomized(), values);
  }
  EXPECT_EQ(BytesOf(scene.model()), own);
}

TEST(EnvRandomize, AStateBringsTheModelOfItsEpisode) {
  const EnvConfig config = Randomized(kAll);
  Env env(config);
  env.Reset({.seed = 4});
  const EnvState state = EnvState::FromNumbers(env.state().numbers());
  const std::vector<std::byte> first = BytesOf(env.scene().model());
  env.Reset({.seed = 5});
  env.SetState(state);
  EXPECT_EQ(BytesOf(env.scene().model()), first);
}

TEST(EnvRandomize, OncePerSceneIsTheSameInAllEpisodes) {
  EnvConfig config = Randomized(kAll);
  config.randomize->every = RandomizeEvery::kScene;
  Env env(config);
  env.Reset({.seed = 1});
  const RandomizedValues values = env.randomized();
  env.Reset({.seed = 2});
  EXPECT_EQ(env.randomized(), values);
  Env again(config), other(config);
  again.Reset({.seed = 1});
  other.Reset({.seed = 2});
  EXPECT_EQ(again.randomized(), values);
  EXPECT_NE(other.randomized(), values) << "the seed of the first reset decides";
  EnvBatch batch(config, 2, 1);
  batch.Reset({});
  EXPECT_NE(batch.env(0).randomized(), batch.env(1).randomized());
}

TEST(EnvRandomize, AStateWithoutASeedIsRefused) {
  Env env(Randomized(kAll));
  env.Reset({.seed = 4});
  for (const double seed : {-1.0, 0.5, 4294967296.0}) {
    EnvState state = env.state();
    state.variations.back() = seed;
    ExpectThrow<ArgumentError>([&] { env.SetState(state); }, "the seed of `randomize`");
  }
}

TEST(EnvRandomize, AnActionTakesEffectAfterItsDelay) {
  const auto moved_after = [](double delay) {
    EnvConfig config = Rc7Env(ControlMode::kJoints, RelativeTo::kLastStep);
    config.sim.async_control = true;
    config.sim.frequency = 20;
    if (delay > 0) config.randomize.emplace().action_delay = RandomNumber{.value = delay};
    Env env(config);
    env.Reset({.seed = 1});
    const double before = env.scene().data()->qpos[0];
    std::vector<double> action(env.layout().action.size(), 0.0);
    action[0] = 0.05;
    const EnvStep step = env.Step(action);
    EXPECT_NEAR(step.time, 0.05, 1e-9);
    return env.scene().data()->qpos[0] - before;
  };
  const double at_once = moved_after(0), later = moved_after(0.046), at_the_end = moved_after(0.05);
  EXPECT_GT(at_once, 2 * later);
  EXPECT_GT(later, 1e-5);
  EXPECT_NEAR(at_the_end, 0, 1e-6);
}

TEST(EnvRandomize, WhatAnEnvironmentCannotDoIsReported) {
  const auto make = [](const EnvConfig& config) { Env env(config); };
  ExpectThrow<SpecError>([&] { make(Randomized("clutter: {number: 2}")); },
                         "add objects to root_frame_objects");
  ExpectThrow<SpecError>([&] { make(Randomized("action_delay: 0.01")); }, "async_control: true");
  ExpectThrow<NotFoundError>([&] { make(Randomized("dynamics: {cubes: {mass: 1}}")); },
                             "Did you mean 'cube'?");
  EnvConfig both = Randomized(kAll);
  both.variations["cube"] = {.mass = {0.5, 2}};
  ExpectThrow<SpecError>([&] { make(both); }, "leave `variations` out");
}

}  // namespace
}  // namespace robocell
