// Tests arms in scenes whose options switch gravity, or its compensation, off: nothing holds them
// against an absent weight.
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/robot/testing/robots.h"

namespace robocell {
namespace {

using Options = std::vector<std::string>;

Robot Without(const Options& options, bool compensated = false) {
  RobotSpec robot{.name = "rc7", .config = Rc7(), .euler = {10, 20, 30}};
  robot.config->gravcomp = compensated;
  robot.control_modes = std::vector{CtrlMode::kVelocity, CtrlMode::kTorque};
  SceneSpec spec = SceneWith(robot);
  spec.options.disable = options;
  return Robot::Of(Scene::Build(spec), "rc7");
}

class ArmsWithout : public ::testing::TestWithParam<Options> {};
INSTANTIATE_TEST_SUITE_P(Disabled, ArmsWithout,
                         ::testing::Values(Options{}, Options{"gravity"}, Options{"spring"},
                                           Options{"damper"}, Options{"spring", "damper"},
                                           Options{"gravity", "spring", "damper"}));

TEST_P(ArmsWithout, NeedTheTorquesOfTheEngine) {
  for (const bool compensated : {false, true}) {
    const Robot robot = Without(GetParam(), compensated);
    std::vector<double> torques(7);
    robot.GravityTorques(torques);
    const mjData* d = robot.scene().data();
    for (int i = 0; i < 7; ++i) {
      const int dof = robot.chain().joints()[i].dof_address;
      EXPECT_NEAR(torques[i], d->qfrc_bias[dof] - d->qfrc_gravcomp[dof], 1e-9) << i;
    }
  }
}

// For a model without compensation, the engine only reads written values once the flag is set.
TEST(CompensationWrittenToTheModel, AppliesAsInTheEngine) {
  Scene scene = Without({}).scene();
  mjModel* m = scene.mutable_model();
  mju_fill(m->body_gravcomp, 1, static_cast<int>(m->nbody));
  for (const bool raised : {false, true}) {
    m->flg_gravcomp = raised;
    scene.Forward();
    const Robot robot = Robot::FromScene(scene, "base_link", "link7");
    std::vector<double> torques(7);
    robot.GravityTorques(torques);
    const mjData* d = scene.data();
    for (int i = 0; i < 7; ++i) {
      const int dof = robot.chain().joints()[i].dof_address;
      EXPECT_NEAR(torques[i], d->qfrc_bias[dof] - d->qfrc_gravcomp[dof], 1e-9) << raised << i;
    }
  }
}

double DriftInASecond(Robot& robot, CtrlMode mode) {
  robot.set_ctrl_mode(mode);
  robot.scene().Reset();
  const std::vector<double> start = robot.arm().joint_pos();
  for (int i = 0; i < 500; ++i) {
    robot.Update();
    EXPECT_TRUE(robot.Step().ok());
  }
  double most = 0;
  for (int i = 0; i < 7; ++i)
    most = std::max(most, std::abs(robot.arm().joint_pos()[i] - start[i]));
  return most;
}

TEST_P(ArmsWithout, HoldStillInTorqueAndVelocityMode) {
  Robot robot = Without(GetParam());
  EXPECT_LT(DriftInASecond(robot, CtrlMode::kTorque), 1e-3);
  EXPECT_LT(DriftInASecond(robot, CtrlMode::kVelocity), 1e-3);
}

TEST(GravityThatIsOff, CanBeOverriddenByTheCaller) {
  const Robot robot = Without({"gravity"});
  EXPECT_EQ(robot.gravity_in_base(), Eigen::Vector3d::Zero());
  EXPECT_NEAR(robot.gravity_in_base(-3).norm(), 3, 1e-12);
}

}  // namespace
}  // namespace robocell
