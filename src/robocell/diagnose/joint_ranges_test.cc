#include "robocell/diagnose/joint_ranges.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/mujoco/names.h"
#include "robocell/scene/testing/arm_with_hand.h"

namespace robocell::internal {
namespace {

// Inspects the compiled robot instead of diagnose's own checks.
class JointRangesTest : public ArmWithHand {
 protected:
  ~JointRangesTest() override { InstallRobotInspection(before_); }
  template <void (*kLook)(const CompiledRobot&)>
  void Look(const ModelText& text) {
    Model(text);
    InstallRobotInspection([](const CompiledRobot& robot, CompileLog&) { kLook(robot); });
    Build();
  }

 private:
  RobotInspection before_ = InstalledRobotInspection();
};

void ExpectItsServos(const CompiledRobot& robot) {
  const JointRanges ranges(robot);
  const MoveGroupConfig& arm = *robot.robot.config.move_groups.find("arm");
  const int hip = ranges.Joint("hip");
  ASSERT_GE(hip, 0);
  EXPECT_EQ(ranges.Joint("hop"), -1);
  EXPECT_TRUE(ranges.IsHinge(hip));
  EXPECT_FALSE(ranges.IsHinge(ranges.Joint("l")));
  EXPECT_STREQ(ranges.Unit(ranges.Joint("l")), "m");
  EXPECT_EQ(ranges.RangeOf(hip).text(), "-2 to 2");
  const int servo = ranges.ServoOf(arm, hip);
  EXPECT_EQ(ranges.Name(mjOBJ_ACTUATOR, servo), "s1");
  ASSERT_TRUE(ranges.ServoSpan(servo));
  EXPECT_EQ(ranges.ServoSpan(servo)->text(), "-0.5 to 1");
  EXPECT_NEAR(ranges.Ctrl(servo, 0.25), 0.25, 1e-12);
  EXPECT_FALSE(ranges.ServoSpan(-1));
}

TEST_F(JointRangesTest, AreThoseOfTheRobotsOwnNames) {
  Look<&ExpectItsServos>({.hip_ctrl = "-0.5 1"});
}

}  // namespace
}  // namespace robocell::internal
