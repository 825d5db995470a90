// What the controllers of this folder do every control tick allocates nothing.
#include <gtest/gtest.h>

#include "robocell/robot/testing/robots.h"
#include "robocell/testing/count_allocations.h"

namespace robocell {
namespace {

TEST(ControlHotPath, AllocatesNothing) {
  Robot robot = RobotAlone(Rc7());
  for (const char* kind : {"joint_impedance", "cartesian_pose", "cartesian_impedance"}) {
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

}  // namespace
}  // namespace robocell
