// Commands beyond limits: clamped, told once, at every way in.
#include "robocell/robot/beyond_limits.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "robocell/base/log.h"
#include "robocell/robot/testing/robots.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class BeyondLimitsTest : public ::testing::Test {
 protected:
  std::vector<std::string> lines_;
  ScopedLogSink sink_{[this](LogLevel, std::string_view text) { lines_.emplace_back(text); }};
};

TEST_F(BeyondLimitsTest, TheNearestValueIsUsedAndToldOnce) {
  BeyondLimits beyond;
  const auto what = [] { return std::string("it"); };
  EXPECT_EQ(beyond.Clamp(0.5, {0, 1}, what), 0.5);
  EXPECT_EQ(beyond.Clamp(1.0001, {0, 1}, what), 1) << "a small overshoot is not worth a word";
  EXPECT_TRUE(std::isnan(beyond.Clamp(NAN, {0, 1}, what))) << "to be refused by whoever uses it";
  EXPECT_THAT(lines_, IsEmpty());
  EXPECT_EQ(beyond.Clamp(50, {0, 1}, what), 1);
  EXPECT_EQ(beyond.Clamp(-50, {0, 1}, what), 0);
  EXPECT_THAT(lines_, ElementsAre("it is commanded to 50, beyond [0, 1]; the nearest value inside "
                                  "is used (said once)"));
}

// A joint that is commanded beyond its limit is driven to the limit, by the port and by an action.
TEST_F(BeyondLimitsTest, AnArmIsDrivenToItsLimits) {
  Robot robot = RobotAlone(Rc7());
  const Interval limits = robot.joint_limits()[3];
  robot.jnt_pos_cmd()[3] = 90;
  robot.Update();
  EXPECT_EQ(robot.arm().ctrl()[3], limits.upper);
  EXPECT_EQ(robot.jnt_pos_cmd()[3], 90) << "the port keeps what was written";
  ASSERT_EQ(lines_.size(), 1u);
  EXPECT_THAT(lines_[0], HasSubstr("group 'arm': joint 'joint4' is commanded to 90, beyond ["));
  std::vector<double> q = robot.arm().joint_pos();
  q[3] = -90;
  robot.Apply({{"arm", GroupCommand::Joints(q)}});
  robot.Update();
  EXPECT_EQ(robot.arm().ctrl()[3], limits.lower);
  EXPECT_EQ(lines_.size(), 1u);
}

TEST_F(BeyondLimitsTest, AnOpeningInPercentIsTold) {
  Robot robot = RobotAlone(Rc7());
  robot.gripper().SetOpening(50);
  EXPECT_EQ(robot.gripper().ctrl()[0], robot.gripper().ctrl_for_opening(1));
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("group 'gripper': opening is commanded to 50")));
  lines_.clear();
  robot.Apply({{"gripper", GroupCommand::Opening(-2)}});
  EXPECT_EQ(robot.gripper().ctrl()[0], robot.gripper().ctrl_for_opening(0));
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("group 'gripper': opening is commanded to -2")));
}

}  // namespace
}  // namespace robocell
