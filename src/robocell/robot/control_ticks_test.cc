#include "robocell/robot/control_ticks.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <span>
#include <vector>

#include "robocell/robot/testing/robots.h"
#include "robocell/scene/testing/gates.h"
#include "robocell/scene/testing/scenes.h"

namespace robocell {
namespace {

TEST(ControlTicks, EachTickUpdatesOnceAndStepsTheEngine) {
  Robot robot = RobotAlone(Rc7());
  Scene scene = robot.scene();
  const double timestep = scene.timestep(), begin = scene.time();
  std::vector<double> times;
  const StepResult result =
      RunControlTicks(scene, {&robot, 1}, {.ticks = 5, .sim_steps = 3},
                      [&](const mjModel*, const mjData* data) { times.push_back(data->time); });
  EXPECT_TRUE(result.ok());
  EXPECT_EQ(result.steps, 15);
  ASSERT_EQ(times.size(), 5);
  for (size_t i = 0; i < times.size(); ++i)
    EXPECT_NEAR(times[i], begin + 3 * timestep * static_cast<double>(i), 1e-9);
  EXPECT_NEAR(scene.time(), begin + 15 * timestep, 1e-9);
}

TEST(ControlTicks, AreTheHandWrittenLoop) {
  Robot robot = RobotAlone(Rc7()), same = RobotAlone(Rc7());
  const std::span<const double> measured = robot.jnt_pos_msr();
  std::vector<double> target(measured.begin(), measured.end());
  target[1] += 0.2;
  for (Robot* each : {&robot, &same}) std::ranges::copy(target, each->jnt_pos_cmd().begin());
  Scene scene = robot.scene();
  EXPECT_TRUE(RunControlTicks(scene, {&robot, 1}, {.ticks = 20, .sim_steps = 2}).ok());
  for (int tick = 0; tick < 20; ++tick) {
    same.Update();
    EXPECT_TRUE(same.scene().StepN(2).ok());
  }
  const mjData *a = scene.data(), *b = same.scene().data();
  for (int i = 0; i < scene.model()->nq; ++i) EXPECT_EQ(a->qpos[i], b->qpos[i]);
}

TEST(ControlTicks, NoTicksDoNothing) {
  Robot robot = RobotAlone(Rc7());
  Scene scene = robot.scene();
  const StepResult result = RunControlTicks(scene, {&robot, 1}, {.ticks = 0});
  EXPECT_TRUE(result.ok());
  EXPECT_EQ(result.steps, 0);
}

TEST(ControlTicks, StopAtDivergence) {
  SceneSpec spec = EmptyScene();
  spec.objects.push_back(BoxObject("cube", {0, 0, 1}));
  Scene scene = Scene::Build(spec);
  int ticks = 0;
  const StepResult result =
      RunControlTicks(scene, {}, {.ticks = 10, .sim_steps = 2}, [&](const mjModel*, const mjData*) {
        if (++ticks == 3) scene.data()->qvel[0] = 1e300;
      });
  EXPECT_FALSE(result.ok());
  EXPECT_LT(ticks, 10);
  EXPECT_GE(result.steps, 4) << "the good steps count";
}

TEST(ControlTicks, EndWhenAViewerHoldsOrStopsTheScene) {
  Robot robot = RobotAlone(Rc7());
  Scene scene = robot.scene();
  int ticks = 0;
  const auto count = [&](const mjModel*, const mjData*) { ++ticks; };
  const auto gate = GateForTests::Of(scene, GateForTests::kHold);
  StepResult result = RunControlTicks(scene, {&robot, 1}, {.ticks = 5, .sim_steps = 3}, count);
  EXPECT_TRUE(result.ok());
  EXPECT_EQ(result.steps, 0);
  EXPECT_EQ(ticks, 1);
  gate->answer = GateForTests::kStop;
  result = RunControlTicks(scene, {&robot, 1}, {.ticks = 5, .sim_steps = 3}, count);
  EXPECT_EQ(result.status, StepResult::kStopped);
  EXPECT_EQ(ticks, 2);
  gate->answer = GateForTests::kGo;
  EXPECT_EQ(RunControlTicks(scene, {&robot, 1}, {.ticks = 5, .sim_steps = 3}, count).steps, 15);
}

}  // namespace
}  // namespace robocell
