#include "robocell/robot/joint_pos_for_ctrl.h"

#include <gtest/gtest.h>

#include "robocell/robot/testing/coupled_arms.h"

namespace robocell {
namespace {

class JointPosForCtrls : public CoupledArms {};

TEST_F(JointPosForCtrls, AreTheCommandsThatSetThem) {
  Robot par = Parallelogram(), tele = Telescope(), diff = Differential();
  const std::vector<std::vector<double>> goals = {
      {0.5, 0.6, -0.4, 0.7, 0.3}, {0.4, 0.08, 0.5, -0.3, 0.6}, {0.5, 0.4, -0.6, 0.3, 0.7, -0.9}};
  size_t next = 0;
  for (Robot* robot : {&par, &tele, &diff}) {
    const std::vector<double>& goal = goals[next++];
    robot->SetJntPosCmd(goal);
    robot->Update();
    std::vector<double> q(goal.size(), 0.05);
    ASSERT_TRUE(internal::JointPosForCtrl(robot->group("arm"), q));
    for (size_t i = 0; i < q.size(); ++i) EXPECT_NEAR(q[i], goal[i], 1e-9) << i;
  }
}

TEST_F(JointPosForCtrls, NeedServosOfTheJointsAlone) {
  const Robot robot = RobotAlone(Rc7());
  std::vector<double> one = {0.3};
  EXPECT_FALSE(internal::JointPosForCtrl(robot.group("gripper"), one));
  EXPECT_EQ(one[0], 0.3);
}

}  // namespace
}  // namespace robocell
