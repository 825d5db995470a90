#include "robocell/motion/timed_path.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <limits>

#include "robocell/mujoco/names.h"
#include "robocell/robot/testing/robots.h"

namespace robocell {
namespace {

TEST(TimedPath, ReachesItsEndInTheRemainingTicks) {
  TimedPath path({0, 1}, 0.066);
  path.AddLeg({{1, 0}}, 1.2, 0.15);
  const int ticks = path.remaining();
  EXPECT_EQ(ticks, 24);  // 1.875 / 1.2 s
  for (int i = 0; i < ticks; ++i) {
    EXPECT_FALSE(path.finished());
    EXPECT_EQ(path.remaining(), ticks - i);
    path.Next();
  }
  EXPECT_TRUE(path.finished());
  EXPECT_EQ(path.Next(), (JointVector{1, 0}));
}

TEST(TimedPath, NoTargetExceedsTheSpeedLimit) {
  TimedPath path({0}, 0.02);
  path.AddLeg({{2}}, 0.8, 0.15);
  double before = 0, fastest = 0;
  while (!path.finished()) {
    const double now = path.Next()[0];
    EXPECT_GE(now, before);
    fastest = std::max(fastest, (now - before) / 0.02);
    before = now;
  }
  EXPECT_LE(fastest, 0.8 + 1e-9);
  EXPECT_GT(fastest, 0.75);
}

TEST(TimedPath, StartsAndEndsEachLegGently) {
  TimedPath path({0}, 0.01);
  path.AddLeg({{1}}, 1, 0.5);
  path.AddLeg({{0}}, 1, 0.5);
  const double first = path.Next()[0];
  EXPECT_LT(first, 1e-4);
  double nearest_end = 0;
  while (path.remaining() > 188) nearest_end = path.Next()[0];
  EXPECT_EQ(nearest_end, 1);
  EXPECT_GT(path.Next()[0], 1 - 1e-4);
}

TEST(TimedPath, ShortMotionsTakeTheLeastTime) {
  TimedPath path({0}, 0.066);
  path.AddLeg({{0.001}}, 1, 0.5);
  EXPECT_EQ(path.remaining(), 8);
}

TEST(TimedPath, StaysOnTheLinesBetweenWaypoints) {
  TimedPath path({0, 0}, 0.01);
  path.AddLeg({{1, 0}, {1, 1}}, 1, 0.5);
  bool passed = false;
  while (!path.finished()) {
    const JointVector q = path.Next();
    EXPECT_TRUE(q[1] == 0 || q[0] == 1) << q[0] << " " << q[1];
    passed |= q[0] > 0.9 && q[1] < 0.1;
  }
  EXPECT_TRUE(passed);
}

// Tests jumps against the engine's own servos: a slightly smaller jump stays under the force limit,
// a slightly larger one does not. Returns the share of its limit that a servo of the resting arm
// uses after a jump of one joint's target.
double ShareOfLimit(Robot robot, int joint, double jump) {
  Scene scene = robot.scene();
  scene.Reset();
  mjModel* m = scene.mutable_model();
  std::fill_n(m->opt.gravity, 3, 0.0);
  std::vector<double> q = robot.arm().joint_pos();
  q[joint] += jump;
  robot.Apply({{robot.arm().name(), GroupCommand::Joints(q)}});
  robot.Update();
  scene.Forward();
  const int a = FindId(m, mjOBJ_ACTUATOR, robot.arm().actuator_names()[joint]);
  return std::abs(scene.data()->actuator_force[a]) / m->actuator_forcerange[2 * a + 1];
}

TEST(ServoJumps, MatchTheForceLimitsOfTheServos) {
  REQUIRE_MENAGERIE("franka_emika_panda", "ufactory_xarm7", "kinova_gen3", "robotiq_2f85");
  for (const RobotConfig& config : {Panda(), XArm7(), Gen3WithTool()}) {
    const Robot robot = RobotAlone(config);
    const std::vector<double> jumps = ServoJumps(robot.scene().model(), robot.arm());
    ASSERT_EQ(jumps.size(), 7u);
    for (int i = 0; i < 7; ++i) {
      EXPECT_NEAR(ShareOfLimit(robot, i, 0.9 * jumps[i]), 0.9, 1e-6) << config.name << i;
      EXPECT_EQ(ShareOfLimit(robot, i, 1.1 * jumps[i]), 1) << config.name << i;
    }
  }
}

TEST(ServoJumps, OfAServoWithoutLimitIsInfinite) {
  const Robot robot = RobotAlone(Rc7());
  mjModel* m = robot.scene().mutable_model();
  std::fill_n(m->actuator_forcelimited, m->nu, mjtByte{0});
  std::fill_n(m->jnt_actfrclimited, m->njnt, mjtByte{0});
  for (const double jump : ServoJumps(m, robot.arm())) EXPECT_TRUE(std::isinf(jump));
}

TEST(ServoJumps, AreTheSameNextToAMultiInputActuator) {
  const auto jumps_of = [](std::string model) {
    ModelFolder folder;
    for (const char* joint : {"shoulder", "elbow"}) {
      const std::string name = std::string("name=\"") + joint + "\"";
      model.insert(model.find(name), "actuatorfrcrange=\"-5 5\" ");
      const std::string on = std::string("joint=\"") + joint + "\" kp";
      model.insert(model.find(on), joint[0] == 's' ? "gear=\"2\" " : "gear=\"-3\" ");
    }
    const Robot robot = RobotAlone(ArmConfig(folder.Write("arm", model)));
    return ServoJumps(robot.scene().model(), robot.arm());
  };
  const std::vector<double> jumps = jumps_of(TwoJointArmWithABall());
  EXPECT_EQ(jumps, jumps_of(kTwoJointArm));
  EXPECT_NEAR(jumps[0], 5.0 / (2 * 2 * 100), 1e-12);
  EXPECT_NEAR(jumps[1], 5.0 / (3 * 3 * 50), 1e-12);
}

TEST(ServoJumps, OfMotorsAreInfinite) {
  ModelFolder folder;
  std::string model = kTwoJointArm;
  const size_t begin = model.find("<position"), end = model.find("</actuator>");
  model.replace(begin, end - begin,
                R"(<motor name="servo1" joint="shoulder" ctrlrange="-9 9"/>
                   <motor name="servo2" joint="elbow" forcerange="-9 9"/>)");
  RobotConfig config = ArmConfig(folder.Write("motors", model));
  config.control["arm"] = ControlKind::kJointImpedance;
  const Robot robot = RobotAlone(config);
  const std::vector<double> jumps = ServoJumps(robot.scene().model(), robot.arm());
  ASSERT_EQ(jumps.size(), 2u);
  for (const double jump : jumps) EXPECT_TRUE(std::isinf(jump));
}

TEST(SecondsForJumps, KeepEveryTargetWithinTheJumps) {
  const JointPath points = {{0, 0}, {0.1, 0.3}, {0.5, 0.4}, {0.6, 0.4}};
  const std::vector<double> jumps = {0.02, 0.05};
  const double tick = 0.066;
  TimedPath path(points.front(), tick);
  path.AddLeg({points.begin() + 1, points.end()}, 100, SecondsForJumps(points, jumps, tick));
  JointVector before = points.front();
  double most = 0;
  while (!path.finished()) {
    const JointVector now = path.Next();
    for (int i = 0; i < 2; ++i) most = std::max(most, std::abs(now[i] - before[i]) / jumps[i]);
    before = now;
  }
  EXPECT_LE(most, 1 + 1e-9);
  EXPECT_GT(most, 0.8) << "no slower than needed";
}

TEST(SecondsForJumps, AreZeroWithoutLimits) {
  EXPECT_EQ(SecondsForJumps({{0.0}, {1.0}}, {std::numeric_limits<double>::infinity()}, 0.05), 0);
}

}  // namespace
}  // namespace robocell
