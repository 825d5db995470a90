// Tests that position servos with a filtered or delayed control begin at their target when the arm
// is switched to them, moved elsewhere, or reset.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>

#include "robocell/mujoco/owners.h"
#include "robocell/robot/testing/robots.h"

namespace robocell {
namespace {

// The force of each on its joint, by length and velocity, is the same except for the filter's
// effect.
constexpr const char* kServos[] = {
    R"(<position name="s" joint="q" kp="100" kv="10"/>)",
    R"(<position name="s" joint="q" kp="100" kv="10" timeconst="0.05"/>)",
    R"(<position name="s" joint="q" kp="100" kv="10" timeconst="0.5"/>)",
    R"(<position name="s" joint="q" kp="25" kv="2.5" gear="-2" timeconst="0.3"/>)",
    R"(<general name="s" joint="q" dyntype="filter" dynprm="0.2" gainprm="50" biastype="affine"
        biasprm="3 -100 -10"/>)",
    R"(<position name="s" joint="q" kp="100" kv="10" delay="0.05" nsample="30"/>)",
    R"(<position name="s" joint="q" kp="100" kv="10" timeconst="0.2" delay="0.02" nsample="12"/>)"};

class FilteredServo : public ::testing::TestWithParam<const char*> {
 protected:
  Robot Build() {
    const std::string model = folder_.Write("arm", std::string(R"(
      <worldbody><body name="base"><body name="link" pos="0 0 1">
        <joint name="q" axis="0 1 0" damping="1"/>
        <geom type="capsule" size="0.02" fromto="0 0 0 0.3 0 0" mass="1"/>
      </body></body></worldbody><actuator>)") + GetParam() +
                                                       "</actuator>");
    RobotSpec spec{.path = model};
    spec.control_modes = std::vector{CtrlMode::kPosition, CtrlMode::kVelocity, CtrlMode::kTorque};
    return Robot::FromScene(Scene::Build(SceneWith(spec)), "base", "link");
  }
  static void Run(Robot& robot, int steps) {
    for (int i = 0; i < steps; ++i) {
      robot.Update();
      ASSERT_TRUE(robot.Step().ok());
    }
  }
  static double Force(const Robot& robot) {
    robot.scene().Forward();
    return robot.arm().joint_torque()[0];
  }
  // Returns the position after some steps of an arm that starts at `q` and whose servo has had that
  // target for a long time.
  static double EngineAfter(const Robot& robot, double q, int steps) {
    const mjModel* m = robot.scene().model();
    const DataPtr d = MakeData(m);
    d->qpos[0] = q;
    const mjtNum* bias = m->actuator_biasprm;
    d->ctrl[0] = -(bias[1] * m->actuator_gear[0] * q + bias[0]) / m->actuator_gainprm[0];
    if (m->na > 0) d->act[0] = d->ctrl[0];
    if (m->nhistory > 0) {
      const std::vector<mjtNum> past(m->actuator_history[0], d->ctrl[0]);
      mj_initCtrlHistory(m, d.get(), 0, nullptr, past.data());
    }
    for (int i = 0; i < steps; ++i) mj_step(m, d.get());
    return d->qpos[0];
  }
  static void ExpectHeldAsByTheEngine(Robot& robot, double q) {
    ASSERT_EQ(robot.arm().joint_pos()[0], q);
    for (int i = 0; i < 10; ++i) {
      Run(robot, 20);
      ASSERT_NEAR(robot.arm().joint_pos()[0], EngineAfter(robot, q, 20 * (i + 1)), 1e-12) << i;
    }
  }

 private:
  ModelFolder folder_;
};
INSTANTIATE_TEST_SUITE_P(Servos, FilteredServo, ::testing::ValuesIn(kServos));

TEST_P(FilteredServo, StartsWithTheForceOfThePreviousMode) {
  Robot robot = Build();
  for (const CtrlMode mode : {CtrlMode::kTorque, CtrlMode::kVelocity}) {
    SCOPED_TRACE(ToString(mode));
    robot.set_ctrl_mode(mode);
    robot.SetJointPos(std::vector<double>{0.5});  // in between, moved elsewhere
    robot.arm().SetJointVel(std::vector<double>{0});
    if (mode == CtrlMode::kTorque) robot.SetJntTrqCmd(std::vector<double>{-1.2});
    Run(robot, 5);
    const double before = Force(robot);
    ASSERT_LT(before, -1);
    robot.set_ctrl_mode(CtrlMode::kPosition);
    EXPECT_NEAR(Force(robot), before, 1e-9);
    robot.Update();
    EXPECT_NEAR(Force(robot), before, 1e-9);
    const double start = robot.arm().joint_pos()[0];
    Run(robot, 300);
    EXPECT_NEAR(robot.arm().joint_pos()[0], start, 0.02);
  }
}

TEST_P(FilteredServo, HoldsATeleportedArm) {
  Robot robot = Build();
  Run(robot, 50);
  for (const double q : {0.5, -0.4}) {
    robot.SetJointPos(std::vector<double>{q}, q > 0);
    robot.arm().SetJointVel(std::vector<double>{0});
    ExpectHeldAsByTheEngine(robot, q);
  }
}

TEST_P(FilteredServo, HoldsAnArmPlacedByAResetHook) {
  Robot robot = Build();
  Scene scene = robot.scene();
  const int hook = scene.AddResetHook(
      [&](ResetContext&) { robot.SetJointPos(std::vector<double>{0.5}, false); });
  Run(robot, 50);
  scene.Reset();
  ExpectHeldAsByTheEngine(robot, 0.5);
  scene.RemoveResetHook(hook);
  scene.AddResetHook([&](ResetContext&) { scene.data()->qpos[0] = -0.4; });
  scene.Reset();
  ExpectHeldAsByTheEngine(robot, -0.4);
}

TEST(IntegratingServo, HoldsATeleportedArm) {
  ModelFolder folder;
  const RobotSpec spec{.path = folder.Write("arm", R"(
      <worldbody><body name="base"><body name="link" pos="0 0 1" gravcomp="1">
        <joint name="q" axis="0 1 0" damping="1"/>
        <geom type="capsule" size="0.02" fromto="0 0 0 0.3 0 0" mass="1"/>
      </body></body></worldbody>
      <actuator><intvelocity joint="q" kp="100" actrange="-3 3"/></actuator>)")};
  Robot robot = Robot::FromScene(Scene::Build(SceneWith(spec)), "base", "link");
  for (const double q : {0.5, -0.4}) {
    robot.SetJointPos(std::vector<double>{q});
    robot.arm().SetJointVel(std::vector<double>{0});
    for (int i = 0; i < 300; ++i) {
      robot.Update();
      ASSERT_TRUE(robot.Step().ok());
    }
    EXPECT_NEAR(robot.arm().joint_pos()[0], q, 1e-9);
  }
}

}  // namespace
}  // namespace robocell
