#include "robocell/scene/inspection/joint_ranges.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <optional>

#include "robocell/mujoco/names.h"
#include "robocell/scene/testing/arm_with_hand.h"
#include "robocell/scene/validate_robot.h"

namespace robocell::internal {
namespace {

using JointRangesTest = ArmWithHand;

TEST_F(JointRangesTest, UseTheNamesOfTheRobot) {
  Model({.hip_ctrl = "-0.5 1"});
  const Scene scene = Build();
  CompileLog log;
  const std::optional<Part> part = LoadPart(model_, "", "robot 'arm'", "model", {}, "", log);
  ASSERT_TRUE(part);
  const DataPtr reference = AtReference(scene.model());
  const CompiledRobot robot{scene.model(), reference.get(), -1, scene.compiled()->robots().at(0),
                            *part};
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

}  // namespace
}  // namespace robocell::internal
