// Tests that the controllers of this folder allocate nothing in a control tick or a batch.
#include <gtest/gtest.h>

#include "robocell/kinematics/chain_batch.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/count_allocations.h"

namespace robocell {
namespace {

TEST(ControlHotPath, AllocatesNothing) {
  Robot robot = RobotAlone(Rc7());
  for (const char* kind :
       {"joint_impedance", "cartesian_pose", "cartesian_impedance", "differential_ik"}) {
    robot.SetController("arm", kind);
    robot.Update();
    EXPECT_TRUE(robot.Step().ok());
    const AllocationCount count;
    for (int i = 0; i < 10; ++i) {
      robot.Update();
      EXPECT_TRUE(robot.Step().ok());
    }
    EXPECT_EQ(count.allocations(), 0) << kind;
  }
}

TEST(BatchHotPath, AllocatesNothing) {
  const Robot robot = RobotAlone(Rc7());
  const std::vector<double> q(9 * 7, 0.3);
  const std::array<double, 3> gravity = {0, 0, -9.81};
  std::vector<double> torques(9 * 7);
  GravityTorquesBatch(robot.chain(), q, gravity, torques);
  const AllocationCount count;
  GravityTorquesBatch(robot.chain(), q, gravity, torques);
  InverseDynamicsBatch(robot.chain(), q, q, q, gravity, torques);
  EXPECT_EQ(count.allocations(), 0);
}

}  // namespace
}  // namespace robocell
