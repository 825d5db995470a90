// Tests properties of every ready-made environment in every scene with every control mode.
#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "robocell/assets/resolve.h"
#include "robocell/env/env.h"
#include "robocell/testing/long_form.h"
#include "robocell/testing/menagerie.h"

namespace robocell {
namespace {

constexpr int kRandomSteps = 50;

using Numbers = std::vector<double>;

// Returns an environment on the floor, or on the built-in table.
EnvConfig ReadyMade(const std::string& name, const std::string& scene, ControlMode mode) {
  EnvConfig config = EnvConfig::Load(assets::BuiltinCellFile(name));
  if (scene == "tabletop") {
    config.scene = scene;
    config.root_frame_to_world = Pose::FromRpy({-0.05, 0, 0.45}, {0, 0, 0.3});
  }
  config.control_mode = mode;
  config.max_relative_movement = mode == ControlMode::kJoints ? Numbers{0.1} : Numbers{0.1, 0.3};
  config.sim.frequency = 125;  // four steps of the engine
  return config;
}

// Returns observations of random steps within the range of actions.
std::vector<Numbers> RandomEpisode(Env& env) {
  Rng rng = Rng::Stream(1, "env cells");
  env.Reset({.seed = 3});
  const VectorRange& range = env.layout().action;
  std::vector<Numbers> seen = {{env.observation().begin(), env.observation().end()}};
  for (int step = 0; step < kRandomSteps; ++step) {
    Numbers action;
    for (int i = 0; i < range.size(); ++i)
      action.push_back(rng.Uniform(range.lower[i], range.upper[i]));
    EXPECT_NE(env.Step(action).reason, EndReason::kDiverged);
    seen.emplace_back(env.observation().begin(), env.observation().end());
  }
  return seen;
}

void ExpectWithin(const VectorRange& range, const Numbers& seen) {
  for (int i = 0; i < range.size(); ++i) {
    EXPECT_GE(seen[i], range.lower[i]) << i;
    EXPECT_LE(seen[i], range.upper[i]) << i;
  }
}

void ExpectNothingStandsStill(const Env& env, const std::vector<Numbers>& seen) {
  for (int i = 0; i < env.layout().observation.size(); ++i) {
    bool moves = false;
    for (const Numbers& each : seen) moves = moves || each[i] != seen.front()[i];
    EXPECT_TRUE(moves) << NameOfObservation(env.layout(), i);
  }
}

class EnvCells : public ::testing::TestWithParam<const char*> {};

TEST_P(EnvCells, FulfilTheContract) {
  if (GetParam() != std::string("rc7"))
    REQUIRE_MENAGERIE("franka_fr3", "franka_emika_panda", "kinova_gen3", "robotiq_2f85",
                      "ufactory_xarm7");
  for (const char* scene : {"empty_world", "tabletop"}) {
    for (const ControlMode mode :
         {ControlMode::kJoints, ControlMode::kCartesianTrpy, ControlMode::kCartesianTquat}) {
      // The short form has each scene and each mode once for each cell; the long form all pairs.
      const bool is_empty = scene == std::string_view("empty_world");
      if (!LongForm() && is_empty != (mode == ControlMode::kCartesianTquat)) continue;
      SCOPED_TRACE(std::string(scene) + " " + ToString(mode));
      Env env(ReadyMade(GetParam(), scene, mode));
      const std::vector<Numbers> seen = RandomEpisode(env);
      EXPECT_EQ(RandomEpisode(env), seen) << "equal seeds";
      for (const Numbers& each : seen) ExpectWithin(env.layout().observation, each);
      ExpectNothingStandsStill(env, seen);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, EnvCells,
                         ::testing::Values("fr3", "fr3_duo", "gen3_2f85", "panda", "rc7", "xarm7"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace robocell
