// Tests environments in which something fails, or that run for long.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "robocell/base/error.h"
#include "robocell/base/units.h"
#include "robocell/env/arm_target.h"
#include "robocell/env/env.h"
#include "robocell/env/testing/envs.h"
#include "robocell/scene/step_gate.h"
#include "robocell/scene/testing/gates.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/menagerie.h"

namespace robocell {
namespace {

using ::testing::HasSubstr;

class EnvTrouble : public ::testing::Test {
 protected:
  // Returns the action of one robot, with its gripper open.
  static std::vector<double> Command(const Env& env, std::vector<double> command) {
    if (env.layout().robots[0].has_gripper) command.push_back(1);
    return command;
  }
  static std::vector<double> Still(const Env& env) { return Command(env, std::vector<double>(7)); }
  static Pose SeenTcp(const Env& env) {
    return internal::PoseOfAction(ControlMode::kCartesianTquat,
                                  env.observation().subspan(env.layout().robots[0].tquat.begin, 7));
  }
  static std::span<const double> SeenJoints(const Env& env) {
    const VectorPart part = env.layout().robots[0].joints;
    return env.observation().subspan(part.begin, part.size);
  }
  static std::vector<double> SentJoints(const Env& env) {
    const auto q = Robot::Of(env.scene(), "robot").controller("arm").commanded_joint_pos();
    return {q.begin(), q.end()};
  }
  // A wall beside the robot, 0.5 s away when it turns there.
  EnvConfig BesideWall() {
    EnvConfig config = Rc7Env(ControlMode::kJoints, RelativeTo::kNone);
    config.world_frame_objects["wall"] = {
        .mjcf_path = folder_.Write("wall", R"(<worldbody><body name="panel">
          <geom size="0.4 0.02 0.6" type="box"/></body></worldbody>)"),
        .offset = Pose(Eigen::Vector3d(0.4, 0.3, 0.6))};
    return config;
  }
  static std::vector<double> TowardsWall(const Env& env) {
    std::vector<double> q(SeenJoints(env).begin(), SeenJoints(env).end());
    q[0] = 1.2;
    return Command(env, q);
  }

  ModelFolder folder_;
};

TEST_F(EnvTrouble, AnUnlimitedHingeIsObservedInItsRange) {
  REQUIRE_MENAGERIE("kinova_gen3");
  EnvConfig config{.control_mode = ControlMode::kCartesianTquat};
  config.robots["robot"] = Gen3WithTool();
  config.sim.max_convergence_time = 0.02;
  config.sim.on_collision = OnCollision::kReport;
  Env env(config);
  env.Reset();
  const EnvLayout& layout = env.layout();
  double farthest = 0;
  for (int step = 0; step < 60; ++step) {
    const std::vector<double> before = SentJoints(env);
    const Quaternion own = SeenTcp(env).quaternion();
    const Quaternion about_z = {0, 0, std::sin(0.15), std::cos(0.15)};
    const Quaternion turn =
        QuaternionProduct(QuaternionProduct(own, about_z), QuaternionInverse(own));
    std::vector<double> action(3);
    action.insert(action.end(), turn.begin(), turn.end());
    EXPECT_TRUE(env.Step(Command(env, action)).ik_failed.empty()) << step;
    const std::vector<double> sent = SentJoints(env);
    for (size_t i = 0; i < 7; ++i) EXPECT_LT(std::abs(sent[i] - before[i]), 1.6);
    farthest = std::max(farthest, std::abs(sent[6]));
    for (int i = 0; i < layout.observation.size(); ++i) {
      EXPECT_GE(env.observation()[i], layout.observation.lower[i]) << i;
      EXPECT_LE(env.observation()[i], layout.observation.upper[i]) << i;
    }
  }
  EXPECT_GT(farthest, 2 * internal::kPi + 1);
}

TEST_F(EnvTrouble, AnInterruptedStepRequiresAReset) {
  Env env(Rc7Env());
  env.Reset();
  Scene scene = env.scene();
  const int hook = scene.AddResetHook([](ResetContext&) { throw Error("no"); });
  ExpectThrow<Error>([&] { env.Reset(); }, "no");
  const char* halfway = "an error ended its last reset or step halfway; call reset to go on";
  ExpectThrow<Error>([&] { (void)env.Step(Still(env)); }, halfway);
  ExpectThrow<Error>([&] { env.Save("now"); }, halfway);
  scene.RemoveResetHook(hook);
  env.Reset();
  env.Save("start");
  // Adds a controller that the environment cannot use, without its knowledge.
  Robot robot = Robot::Of(scene, "robot");
  robot.SetController("arm", "cartesian_pose");
  robot.SetController("arm", "differential_ik");
  ExpectThrow<ArgumentError>([&] { (void)env.Step(Still(env)); }, "takes a twist");
  ExpectThrow<Error>([&] { (void)env.Step(Still(env)); }, halfway);
  robot.SetController("arm", "joint_position");
  env.Restore("start");
  EXPECT_EQ(env.Step(Still(env)).reason, EndReason::kArrived);
}

TEST_F(EnvTrouble, RejectsControllersThatTakeNoJointPositions) {
  struct Refused {
    ControlKind kind;
    std::string text;
  };
  const Refused refused[] = {
      {ControlKind::kCartesianPose, "'cartesian_pose' takes a pose"},
      {ControlKind::kCartesianImpedance, "'cartesian_impedance' takes a pose"},
      {ControlKind::kJointVelocity, "'joint_velocity' takes joint velocities"},
      {ControlKind::kJointTorque, "'joint_torque' takes joint torques"},
  };
  EnvConfig config = Rc7Env();
  for (const Refused& one : refused) {
    config.robots["robot"].control["arm"] = one.kind;
    ExpectThrow<ArgumentError>([&] { Env env(config); },
                               "environment 'env' / robot 'robot': its controller " + one.text +
                                   ", but an environment sends joint positions");
  }
  for (const ControlKind kind : {ControlKind::kJointPosition, ControlKind::kJointImpedance,
                                 ControlKind::kRelativeJointPosition}) {
    config.robots["robot"].control["arm"] = kind;
    Env env(config);
    env.Reset();
    EXPECT_NE(env.Step(Still(env)).reason, EndReason::kIkFailed) << static_cast<int>(kind);
  }
}

TEST_F(EnvTrouble, AfterACollisionTheNextStepEndsAtTheNextMultiple) {
  EnvConfig config = BesideWall();
  config.sim.async_control = true;
  config.sim.frequency = 5;
  Env env(config);
  env.Reset();
  const std::vector<double> turned = TowardsWall(env);
  EnvStep step;
  while (step.reason != EndReason::kCollision && step.time < 3) step = env.Step(turned);
  ASSERT_EQ(step.reason, EndReason::kCollision);
  const double next = (std::floor(step.time * 5) + 1) / 5;
  EXPECT_LT(step.time, next - 0.01) << "it ended early";
  EXPECT_NEAR(env.Step(turned).time, next, 1e-9);
  EXPECT_NEAR(env.Step(turned).time, next + 0.2, 1e-9);
}

TEST_F(EnvTrouble, ARestoredStateHasTheSameCollisions) {
  EnvConfig config = BesideWall();
  config.sim.async_control = true;
  config.sim.frequency = 1 / config.sim.timestep;
  config.sim.on_collision = OnCollision::kReport;
  Env env(config);
  env.Reset();
  const std::vector<double> turned = TowardsWall(env);
  std::vector<std::vector<Collision>> met;
  const auto name = [](size_t step) { return std::to_string(step); };
  size_t first = 0;
  // Runs to the first tick at which it touches, and a little further.
  while (met.size() < 1000 && (first == 0 || met.size() < first + 5)) {
    env.Save(name(met.size()));
    met.push_back(env.Step(turned).collisions);
    if (first == 0 && !met.back().empty()) first = met.size();
  }
  ASSERT_GT(first, 5u);
  for (size_t step = first - 5; step < met.size(); ++step) {
    env.Restore(name(step));
    EXPECT_EQ(env.Step(turned).collisions, met[step]) << step;
  }
}

TEST_F(EnvTrouble, RejectsExtremeTimes) {
  EnvConfig config = Rc7Env();
  config.sim.max_convergence_time = 1e300;
  const char* text = "sim.max_convergence_time";
  ExpectThrow<SpecError>([&] { Env env(config); }, text);
  config.sim.max_convergence_time = 1;
  Env good(config);
  config.sim.max_convergence_time = 1e300;
  ExpectThrow<SpecError>([&] { Env(config, good.scene()); }, text);
  config.sim = {.async_control = true, .frequency = 1e-9};
  ExpectThrow<SpecError>([&] { Env env(config); }, "sim.frequency");
}

TEST_F(EnvTrouble, AStepThatAViewerStoppedIsNoDivergence) {
  Env env(Rc7Env(ControlMode::kJoints, RelativeTo::kNone));
  env.Reset();
  const std::vector<double> action = TowardsWall(env);
  const auto gate = GateForTests::Of(env.scene(), GateForTests::kStop);
  const EnvStep stopped = env.Step(action);
  EXPECT_EQ(stopped.reason, EndReason::kStopped);
  EXPECT_STREQ(ToString(stopped.reason), "stopped");
  EXPECT_THAT(stopped.message, HasSubstr("the window is closed"));
  EXPECT_EQ(stopped.time, 0);
  gate->answer = GateForTests::kGo;
  EXPECT_NE(env.Step(action).reason, EndReason::kStopped) << "it goes on without a reset";
}

TEST_F(EnvTrouble, ItsSceneSaysThatEpisodesStepIt) {
  const Env env(Rc7Env(ControlMode::kJoints, RelativeTo::kNone));
  EXPECT_NE(env.scene().FindObserver(internal::kEpisodesKey), nullptr);
}

}  // namespace
}  // namespace robocell
