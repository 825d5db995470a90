// Tests that the code of every engine step allocates nothing.
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/env/arm_driver.h"
#include "robocell/env/env.h"
#include "robocell/env/stepper.h"
#include "robocell/env/testing/envs.h"
#include "robocell/env/testing/one_hinge.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/count_allocations.h"

namespace robocell {
namespace {

TEST(HotPath, OfTheStepperAllocatesOnlyForTheAction) {
  const Robot robot = RobotAlone(Rc7());
  Stepper stepper(robot.scene(), {robot}, {33, 1});
  double sum = 0;
  stepper.set_on_control_tick([&](const mjModel*, const mjData* d) { sum += d->ctrl[0]; });
  stepper.Advance({});
  const Action none;
  const AllocationCount count;
  for (int i = 0; i < 20; ++i) stepper.Advance(none);
  EXPECT_EQ(count.allocations(), 0);
}

TEST(HotPath, OfWatchingAMotionAllocatesNothing) {
  ModelFolder folder;
  for (const EnvConfig& config : {OneHinge(folder), Rc7Env()}) {
    Env env(config);
    env.Reset({.seed = 1});
    internal::ArmDriver driver(config, Robot::Of(env.scene(), "robot"), env.layout().robots[0]);
    driver.Reset();
    env.Step(std::vector<double>(static_cast<size_t>(env.layout().action.size()), 0.02));
    const AllocationCount count;
    for (int i = 0; i < 100; ++i) {
      driver.Watch(env.scene().time() + 0.01 * i);
      (void)driver.Status(env.scene().time() + 0.01 * i);
      (void)driver.motion();
    }
    EXPECT_EQ(count.allocations(), 0);
  }
}

}  // namespace
}  // namespace robocell
