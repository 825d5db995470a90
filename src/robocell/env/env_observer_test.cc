#include "robocell/env/env_observer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "robocell/env/env.h"
#include "robocell/env/testing/envs.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;

// Records its calls; ticks as their number.
struct Listener : EnvObserver {
  std::vector<std::string> heard;
  std::vector<double> times;
  int ticks = 0;

  void OnStart() override { heard.emplace_back("start"); }
  void OnAction(std::span<const double> action) override {
    heard.push_back("action of " + std::to_string(action.size()));
    ticks = 0;
    times.clear();
  }
  void OnControlTick(const mjModel*, const mjData* data) override {
    ++ticks;
    times.push_back(data->time);
  }
  void OnTakenBack() override {
    heard.push_back("taken back after " + std::to_string(ticks));
    ticks = 0;
  }
  void OnStep(const EnvStep& step) override { heard.emplace_back(ToString(step.reason)); }
};

EnvConfig EveryTenthOfASecond() {
  EnvConfig config = Rc7Env();
  config.sim.async_control = true;
  config.sim.frequency = 10;
  return config;
}

TEST(EnvObservers, ReceiveEpisodesActionsTicksAndSteps) {
  Env env(EveryTenthOfASecond());
  Listener listener;
  env.AddObserver(&listener);
  env.Reset({.seed = 1});
  const std::vector<double> still(static_cast<size_t>(env.layout().action.size()), 0);
  env.Step(still);
  EXPECT_EQ(listener.ticks, 50);
  EXPECT_DOUBLE_EQ(listener.times.front(), 0);
  EXPECT_NEAR(listener.times.back(), 0.098, 1e-9);
  env.SetState(env.state());
  EXPECT_THAT(listener.heard, ElementsAre("start", "action of 8", "timeout", "start"));
  EXPECT_ANY_THROW(env.Step(std::vector<double>(2)));
  EXPECT_EQ(listener.heard.size(), 4u) << "what is refused is no step";
  env.RemoveObserver(&listener);
  env.RemoveObserver(&listener);
  env.Step(still);
  EXPECT_EQ(listener.heard.size(), 4u);
}

TEST(EnvObservers, ReceiveStepsThatAGuardRevokes) {
  EnvConfig config = Rc7BesideAWall();
  config.sim.on_collision = OnCollision::kGuard;
  Env env(config);
  Listener listener;
  env.AddObserver(&listener);
  env.Reset({.seed = 1});
  std::vector<double> turned(8);
  turned[0] = 1.2;
  EXPECT_EQ(env.Step(turned).reason, EndReason::kCollision);
  ASSERT_EQ(listener.heard.size(), 4u);
  EXPECT_TRUE(listener.heard[2].starts_with("taken back after "));
  EXPECT_GT(listener.ticks, 0) << "of the arms that are held";
}

TEST(EnvObservers, AllSeeAStepEvenIfTheFirstThrows) {
  struct Failing : EnvObserver {
    void OnStep(const EnvStep&) override { throw std::runtime_error("the disk is full"); }
  };
  Env env(EveryTenthOfASecond());
  Failing failing;
  Listener listener;
  env.AddObserver(&failing);
  env.AddObserver(&listener);
  env.Reset({.seed = 1});
  const std::vector<double> still(static_cast<size_t>(env.layout().action.size()), 0);
  EXPECT_THROW(env.Step(still), std::runtime_error);
  EXPECT_THAT(listener.heard, ElementsAre("start", "action of 8", "timeout"));
}

TEST(EnvObservers, ChangeNothing) {
  const auto run = [](bool observed) {
    Env env(EveryTenthOfASecond());
    Listener listener;
    if (observed) env.AddObserver(&listener);
    env.Reset({.seed = 1});
    for (int i = 0; i < 5; ++i)
      env.Step(std::vector<double>(static_cast<size_t>(env.layout().action.size()), 0.02));
    return env.state().numbers();
  };
  EXPECT_EQ(run(true), run(false));
}

}  // namespace
}  // namespace robocell
