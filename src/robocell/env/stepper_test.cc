// Tests the stepper: exact ticks, the state at control ticks, divergence, messages.
#include "robocell/env/stepper.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>

#include "robocell/base/error.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

class StepperTest : public ::testing::Test {
 protected:
  Stepper Make(int control_ticks, int sim_steps) {
    return Stepper(robot.scene(), {robot}, {control_ticks, sim_steps});
  }

  Robot robot = RobotAlone(Rc7());
  const std::vector<double> home = Rc7().home.at("arm");
};

TEST_F(StepperTest, RunsTheRequestedControlTicksAndEngineSteps) {
  Stepper stepper = Make(5, 3);
  std::vector<double> times;
  stepper.set_on_control_tick([&](const mjModel*, const mjData* d) { times.push_back(d->time); });
  const StepOutcome outcome = stepper.Advance({});
  EXPECT_TRUE(outcome.ok());
  EXPECT_EQ(outcome.step.steps, 15);
  EXPECT_NEAR(outcome.step.time, 15 * 0.002, 1e-12);
  ASSERT_EQ(times.size(), 5u);
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(times[i], i * 3 * 0.002, 1e-12);
  EXPECT_EQ(stepper.policy_ticks(), 1);
}

TEST_F(StepperTest, DoesNotDriftOverTenThousandPolicyTicks) {
  ModelFolder folder;
  const Scene scene = Scene::Build(SceneWith({.path = folder.Write("arm", kTwoJointArm)}));
  Stepper stepper(scene, {}, {.control_ticks = 33, .sim_steps = 1});
  int64_t ticks = 0, steps = 0;
  stepper.set_on_control_tick([&](const mjModel*, const mjData*) { ++ticks; });
  for (int i = 0; i < 10000; ++i) steps += stepper.Advance({}).step.steps;
  EXPECT_EQ(stepper.policy_ticks(), 10000);
  EXPECT_EQ(ticks, 330000);
  EXPECT_EQ(steps, 330000);
  EXPECT_EQ(std::llround(scene.time() / scene.timestep()), 330000);
  EXPECT_NEAR(scene.time(), 660, 1e-7);
}

TEST_F(StepperTest, AdvancesUntilAConditionOrTheLastTick) {
  Stepper stepper = Make(33, 2);
  int calls = 0;
  EXPECT_EQ(stepper.AdvanceUntil({}, 10, [&] { return ++calls == 4; }).step.steps, 8);
  EXPECT_EQ(stepper.AdvanceUntil({}, 10, [] { return false; }).step.steps, 20);
  EXPECT_EQ(stepper.policy_ticks(), 2);
}

TEST_F(StepperTest, ControlTicksSeeTheAppliedControls) {
  Stepper stepper = Make(2, 1);
  std::vector<double> seen;
  stepper.set_on_control_tick([&](const mjModel*, const mjData* d) {
    seen.insert(seen.end(), d->ctrl, d->ctrl + 8);  // servos and gripper; motors come after
  });
  std::vector<double> q = home;
  q[0] = 0.4;
  stepper.Advance(
      {{"rc7", {{"arm", GroupCommand::Joints(q)}, {"gripper", GroupCommand::Opening(0)}}}});
  ASSERT_EQ(seen.size(), 16u);
  q.push_back(0);
  std::vector<double> both = q;
  both.insert(both.end(), q.begin(), q.end());
  EXPECT_EQ(seen, both);
}

// The recorded controls, replayed in the bare engine, give the same state.
TEST_F(StepperTest, RecordedControlsReplayBitwiseInTheEngine) {
  Scene scene = robot.scene();
  const mjModel* m = scene.model();
  std::unique_ptr<mjData, void (*)(mjData*)> data(mj_copyData(nullptr, m, scene.data()),
                                                  mj_deleteData);
  Stepper stepper = Make(20, 2);
  stepper.set_on_control_tick([&](const mjModel*, const mjData* d) {
    std::copy_n(d->ctrl, m->nu, data->ctrl);
    mj_step(m, data.get());
    mj_step(m, data.get());
  });
  for (int i = 0; i < 10; ++i) {
    const double turn = 0.1 * std::sin(i);
    stepper.Advance({{"rc7",
                      {{"arm", GroupCommand::RelativeJoints({turn, 0, turn, 0, 0, turn, 0})},
                       {"gripper", GroupCommand::Opening(i % 2)}}}});
    for (int j = 0; j < m->nq; ++j) EXPECT_EQ(scene.data()->qpos[j], data->qpos[j]);
  }
}

TEST_F(StepperTest, DrivesEveryRobotOfTheScene) {
  SceneSpec spec = EmptyScene();
  spec.robots.push_back({.config = Rc7(), .prefix = "l_", .pos = {0, 1, 0}});
  spec.robots.push_back({.config = Rc7(), .prefix = "r_"});
  const Scene scene = Scene::Build(spec);
  Stepper stepper(scene, RobotsOf(scene), {});
  std::vector<double> q = home;
  q[0] = 0.3;
  Action action;
  for (const char* name : {"l", "r"}) action[name]["arm"] = GroupCommand::Joints(q);
  for (int i = 0; i < 30; ++i) stepper.Advance(action);
  for (const Robot& arm : stepper.robots()) EXPECT_NEAR(arm.arm().joint_pos()[0], 0.3, 1e-4);
}

TEST_F(StepperTest, StopsAtDivergenceAndReportsThePlace) {
  Stepper stepper = Make(33, 1);
  EXPECT_TRUE(stepper.Advance({}).ok());
  int ticks = 0;
  stepper.set_on_control_tick([&](const mjModel*, const mjData*) { ++ticks; });
  robot.scene().data()->qvel[2] = 1e12;
  const StepOutcome outcome = stepper.Advance({});
  EXPECT_FALSE(outcome.ok());
  EXPECT_EQ(ticks, 1);
  EXPECT_EQ(outcome.step.steps, 1);
  EXPECT_NE(outcome.step.message.find("diverged"), std::string::npos) << outcome.step.message;
  EXPECT_EQ(outcome.step.joint_name, "joint3");
  EXPECT_NEAR(outcome.step.time, 33 * 0.002, 1e-9) << "the last good state";
}

TEST_F(StepperTest, ReportsAPoseOutOfReachAndContinues) {
  Stepper stepper = Make(3, 1);
  const StepOutcome outcome =
      stepper.Advance({{"rc7", {{"arm", GroupCommand::LeafPose(Pose(Eigen::Vector3d(0, 0, 9)))}}}});
  EXPECT_TRUE(outcome.ok());
  EXPECT_EQ(outcome.failed_robot, "rc7");
  EXPECT_EQ(outcome.failed_group, "arm");
  EXPECT_EQ(outcome.step.steps, 3);
  EXPECT_EQ(robot.controller("arm").commanded_joint_pos()[0], home[0]);
}

TEST_F(StepperTest, RejectsInvalidArguments) {
  ExpectThrow<ArgumentError>(
      [&] { Make(0, 1); },
      "stepper: 0 control ticks of 1 engine steps per policy tick; both must "
      "be at least 1");
  const Robot stranger = RobotAlone(Rc7());
  ExpectThrow<ArgumentError>([&] { Stepper(robot.scene(), {stranger}, {}); },
                             "stepper: robot 'rc7' belongs to another scene ('test')");
  Stepper stepper = Make(1, 1);
  Action action;
  action["rc7"]["arm"] = GroupCommand::Joints(std::vector<double>(7));
  action["rc8"]["arm"] = GroupCommand::Joints(std::vector<double>(7));
  ExpectThrow<NotFoundError>([&] { stepper.Advance(action); },
                             "action: no robot 'rc8'. Its robots: rc7. Did you mean 'rc7'?");
  EXPECT_EQ(robot.controller("arm").commanded_joint_pos()[1], home[1]) << "nothing was applied";
  EXPECT_EQ(robot.scene().time(), 0);
  EXPECT_EQ(stepper.policy_ticks(), 0);
}

TEST_F(StepperTest, RejectsInvalidNumbersByNameAndDoesNotAdvance) {
  Stepper stepper = Make(2, 1);
  std::vector<double> q = home;
  q[5] = std::nan("");
  const std::string arm = "robot 'rc7' / group 'arm': ";
  ExpectThrow<ArgumentError>(
      [&] {
        stepper.Advance({{"rc7", {{"arm", GroupCommand::Joints(q)}}}});
      },
      arm + "the target of 'joint6' is nan; targets must be finite");
  ExpectThrow<ArgumentError>(
      [&] {
        stepper.Advance({{"rc7", {{"arm", GroupCommand::Joints({1, 2})}}}});
      },
      arm + "expected 7 joint values, got 2");
  EXPECT_EQ(robot.scene().time(), 0);
  EXPECT_EQ(stepper.policy_ticks(), 0);
  EXPECT_TRUE(stepper.Advance({}).ok());
  EXPECT_EQ(robot.controller("arm").commanded_joint_pos()[5], home[5]);
}

TEST_F(StepperTest, DivergesTwiceInARowAndRecoversWithAReset) {
  Stepper stepper = Make(3, 1);
  Scene scene = robot.scene();
  scene.Reset();
  stepper.Advance({});
  const std::vector<double> good = scene.state();
  for (const char* joint : {"joint2", "joint5"}) {
    scene.Reset();
    EXPECT_TRUE(stepper.Advance({}).ok());
    EXPECT_EQ(scene.state(), good) << "nothing is left of the divergence before";
    const int id = mj_name2id(scene.model(), mjOBJ_JOINT, joint);
    scene.data()->qvel[scene.model()->jnt_dofadr[id]] = std::nan("");
    const StepOutcome outcome = stepper.Advance({});
    EXPECT_FALSE(outcome.ok());
    EXPECT_EQ(outcome.step.joint_name, joint);
    EXPECT_EQ(outcome.step.time, 3 * 0.002);
  }
}

}  // namespace
}  // namespace robocell
