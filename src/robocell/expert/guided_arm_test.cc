#include "robocell/expert/guided_arm.h"

#include <gtest/gtest.h>

#include "robocell/testing/pick_scene.h"

namespace robocell {
namespace {

constexpr double kTick = 0.066;

struct Moving {
  Moving() : pick(MakePickScene(ObjectOnTheTable("box"))), arm(pick.robot, kTick) {}
  // Simulates one policy tick with this target.
  void Tick(const JointVector& target) {
    RobotAction action;
    action["arm"] = GroupCommand::Joints(std::vector<double>(target.begin(), target.end()));
    EXPECT_TRUE(pick.robot.Apply(action).ok);
    for (int i = 0; i < 33; ++i) {
      pick.robot.Update();
      EXPECT_TRUE(pick.scene.Step().ok());
    }
  }
  JointVector Goal() const {
    JointVector goal = pick.home();
    goal[0] += 0.4;
    return goal;
  }

  PickScene pick;
  GuidedArm arm;
};

TEST(GuidedArm, SettlesWhereItsPathEnds) {
  Moving moving;
  const JointVector goal = moving.Goal();
  moving.arm.Begin();
  moving.arm.AddLeg({goal}, 1.0, 0.3);
  int ticks = 0;
  while (!moving.arm.Settled() && ticks < 100) {
    EXPECT_FALSE(moving.arm.Blocked());
    moving.Tick(moving.arm.Next());
    ++ticks;
  }
  EXPECT_EQ(moving.arm.target(), goal);
  EXPECT_NEAR(moving.pick.robot.arm().joint_pos()[0], goal[0], 0.01);
  EXPECT_GT(ticks, moving.arm.Ticks(0.3));
  EXPECT_LT(ticks, moving.arm.Ticks(2));
}

TEST(GuidedArm, IsBlockedWhereTheArmDoesNotFollow) {
  Moving moving;
  moving.arm.Begin();
  moving.arm.AddLeg({moving.Goal()}, 4.0, 0.1);
  const JointVector home = moving.pick.home();
  bool blocked = false;
  for (int i = 0; i < 12 && !blocked; ++i) {
    blocked = moving.arm.Blocked();
    moving.arm.Next();
    moving.Tick(home);
  }
  EXPECT_TRUE(blocked);
  moving.arm.Unblock();
  moving.arm.TakeMeasured();
  EXPECT_NEAR(moving.arm.target()[0], home[0], 0.01);
  EXPECT_FALSE(moving.arm.Blocked());
}

TEST(GuidedArm, GentleMotionsTakeAsLongAsTheServosNeed) {
  Moving moving;
  const JointPath path = {moving.pick.home(), moving.Goal()};
  const double alone = moving.arm.GentleSeconds(path, 0, 100);
  EXPECT_GT(alone, 0);
  EXPECT_EQ(moving.arm.GentleSeconds(path, alone + 1, 100), alone + 1);
  EXPECT_EQ(moving.arm.GentleSeconds(path, 0, alone / 2), alone / 2);
}

}  // namespace
}  // namespace robocell
