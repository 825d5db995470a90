#include "robocell/hardware/simulated_arm.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/hardware/arm_port.h"
#include "robocell/robot/robot.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

TEST(SimulatedArm, IsTheRobotOfTheModel) {
  SimulatedArm arm(RobotAlone(Rc7()), {.real_time = false});
  ArmMeasurement measured;
  ASSERT_TRUE(arm.Read(measured));
  EXPECT_FALSE(arm.Read(measured)) << "nothing new";
  ASSERT_EQ(measured.pos.size(), arm.joint_names().size());
  ArmCommand command{.pos = measured.pos, .vel = measured.vel, .opening = 0};
  command.pos[0] += 0.2;
  for (int i = 0; i < 200; ++i) {
    arm.Send(command);
    arm.WaitUntil(arm.now() + 0.01);
  }
  ASSERT_TRUE(arm.Read(measured));
  EXPECT_NEAR(measured.pos[0], command.pos[0], 0.01);
  EXPECT_LT(measured.opening, 0.1);
  EXPECT_EQ(measured.time, arm.now());
}

TEST(SimulatedArm, HoldsWithoutCommands) {
  SimulatedArm arm(RobotAlone(Rc7()), {.real_time = false, .watchdog = 0.1});
  ArmMeasurement measured;
  (void)arm.Read(measured);
  std::vector<double> far = measured.pos;
  far[0] += 1;
  arm.Send({.pos = far, .vel = measured.vel});
  arm.WaitUntil(arm.now() + 2);
  (void)arm.Read(measured);
  EXPECT_LT(std::abs(far[0] - measured.pos[0]), 1);
  EXPECT_GT(std::abs(far[0] - measured.pos[0]), 0.05) << "it did not get there";
  EXPECT_LT(std::abs(measured.vel[0]), 0.01);
}

TEST(SimulatedArm, MeasuresWithNoise) {
  SimulatedArm arm(RobotAlone(Rc7()), {.real_time = false, .noise = 0.01, .seed = 3});
  ArmMeasurement measured;
  double sum = 0;
  for (int i = 0; i < 100; ++i) {
    arm.WaitUntil(arm.now() + 0.002);
    ASSERT_TRUE(arm.Read(measured));
    const double off = measured.pos[0] - arm.robot().jnt_pos_msr()[0];
    sum += off * off;
  }
  EXPECT_NEAR(std::sqrt(sum / 100), 0.01, 0.003);
}

TEST(SimulatedArm, RejectsOptionsThatGuardNothing) {
  const Robot robot = RobotAlone(Rc7());
  ExpectThrow<ArgumentError>([&] { const SimulatedArm arm(robot, {.watchdog = std::nan("")}); },
                             "watchdog nan");
  ExpectThrow<ArgumentError>([&] { const SimulatedArm arm(robot, {.noise = -1}); }, "noise is -1");
}

TEST(SimulatedArm, MovesInRealTimeWhenItIsRead) {
  SimulatedArm arm(RobotAlone(Rc7()));
  ArmMeasurement measured;
  const double begin = arm.now();
  arm.WaitUntil(begin + 0.01);
  ASSERT_TRUE(arm.Read(measured));
  EXPECT_GE(measured.time, begin + 0.009);
}

}  // namespace
}  // namespace robocell
