#include "robocell/scene/robot_inspection.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/mujoco/names.h"
#include "robocell/scene/testing/arm_with_hand.h"

namespace robocell::internal {
namespace {

using ::testing::Contains;
using ::testing::Not;

// Restores the inspection of other tests.
class RobotInspectionTest : public ArmWithHand {
 protected:
  ~RobotInspectionTest() override { InstallRobotInspection(before_); }

 private:
  RobotInspection before_ = InstalledRobotInspection();
};

void WarnOfItsHip(const CompiledRobot& robot, CompileLog& log) {
  EXPECT_EQ(robot.model->key_qpos[robot.home_key * robot.model->nq], 0);
  const int fore = FindId(robot.model, mjOBJ_BODY, "a/fore");
  EXPECT_NEAR(robot.reference->xpos[3 * fore + 2], 0.4, 1e-9) << "poses are those of the reference";
  log.Warn(robot.place(), "looked at " + robot.robot.prefix);
}

TEST_F(RobotInspectionTest, WarnsAtEveryCompileThatFollows) {
  Model();
  EXPECT_THAT(Build().compiled()->warnings(), Not(Contains("robot 'arm': looked at a/")));
  InstallRobotInspection(&WarnOfItsHip);
  EXPECT_THAT(Build().compiled()->warnings(), Contains("robot 'arm': looked at a/"));
}

}  // namespace
}  // namespace robocell::internal
