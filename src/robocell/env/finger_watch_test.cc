// Tests that a step only ends with the fingers at rest, whatever the opening is. The oracle is the
// engine's velocity of the finger joints.
#include "robocell/env/finger_watch.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "robocell/env/env.h"
#include "robocell/env/testing/envs.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/gripper_group.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/menagerie.h"

namespace robocell::internal {
namespace {

using Numbers = std::vector<double>;

constexpr double kTravel = 0.04;                  // m, of each slide
constexpr double kAtRest = 0.02 * 1.5 * kTravel;  // m/s: 2 % of it a second, on average

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  const size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

class FingerWatchTest : public ::testing::Test {
 protected:
  // Two slides that a servo with these parameters moves.
  EnvConfig Slides(const std::string& servo, const std::string& friction = "0") {
    std::string model = Replaced(kTwoFingerGripper, R"(biasprm="0 -1000 -10")", servo);
    model =
        Replaced(model, R"(range="0 0.04")", R"(range="0 0.04" frictionloss=")" + friction + "\"");
    for (const auto& [name, y] : {std::pair{"left", "0.01"}, {"right", "-0.01"}}) {
      const std::string body = std::string("<body name=\"") + name + "\" pos=\"0 ";
      model = Replaced(model, body + "0 ", body + y + " ");  // apart when closed
    }
    EnvConfig config;
    config.control_mode = ControlMode::kJoints;
    config.relative_to = RelativeTo::kLastStep;
    config.sim.max_convergence_time = 10;
    config.robots["robot"] = arms_.arm();
    config.robots["robot"].gravcomp = true;
    config.grippers["robot"] = arms_.gripper();
    config.grippers["robot"].model = folder_.Write("hand", model);
    config.grippers["robot"].gravcomp = true;
    return config;
  }

  static double SpeedOfFingers(const Env& env) {
    const mjModel* m = env.scene().model();
    double most = 0;
    for (const char* name : {"gripperrobot_left_slide", "gripperrobot_right_slide"}) {
      const int joint = RequireId(m, mjOBJ_JOINT, name, "test");
      most = std::max(most, std::abs(env.scene().data()->qvel[m->jnt_dofadr[joint]]));
    }
    return most;
  }

  TwoArmFolder arms_;
  ModelFolder folder_;
};

TEST_F(FingerWatchTest, WaitsForFingersThatMoveBeyondTheirRange) {
  EnvConfig config = Slides(R"(biasprm="0 -1000 -300")");
  config.grippers["robot"].move_groups.find("gripper")->joint_range =
      GripperJointRange{0.02, 0.015};
  Env env(config);
  env.Reset({.seed = 1});
  for (const double opening : {1.0, 0.0, 1.0}) {
    ASSERT_EQ(env.Step(Numbers{0, 0, opening}).reason, EndReason::kArrived) << opening;
    EXPECT_LT(SpeedOfFingers(env), kAtRest) << opening;
    EXPECT_NEAR(env.scene().joint_pos("gripperrobot_left_slide"), opening * kTravel, 2e-3);
  }
}

TEST_F(FingerWatchTest, WaitsForFingersThatStartLate) {
  EnvConfig config = Slides(R"(biasprm="0 -1000 -20" dyntype="filterexact" dynprm="0.5")", "4");
  Env env(config);
  env.Reset({.seed = 1});
  const auto& hand = Robot::Of(env.scene(), "gripperrobot").gripper();
  for (const double opening : {0.0, 1.0, 0.0}) {
    const EndReason reason = env.Step(Numbers{0, 0, opening}).reason;
    EXPECT_LT(SpeedOfFingers(env), kAtRest) << opening;
    const double off = std::abs(hand.opening() - opening);
    EXPECT_LT(off, 0.25) << "dry friction stops them before their target";
    EXPECT_EQ(reason, off < 0.05 ? EndReason::kArrived : EndReason::kSettled) << opening;
  }
}

// A motor's control is a force: nothing holds its fingers half open.
TEST_F(FingerWatchTest, FingersShortOfTheirOpeningSettleUnlessTheyHoldAnObject) {
  EnvConfig config = Slides(R"(biasprm="0 0 0")");
  config.grippers["robot"].edits = {
      {.actuator = ElementRef{.name = "grip"}, .ctrlrange = Vec2{-20, 20}}};
  for (const char* joint : {"left_slide", "right_slide"})
    config.grippers["robot"].edits.push_back({.joint = ElementRef{.name = joint}, .damping = 40});
  config.grippers["robot"].move_groups.find("gripper")->ctrl.reset();
  config.wrappers.binary_gripper = false;
  Env env(config);
  env.Reset({.seed = 1});
  const auto& hand = Robot::Of(env.scene(), "gripperrobot").gripper();
  for (const double opening : {1.0, 0.5, 0.0}) {
    const EndReason reason = env.Step(Numbers{0, 0, opening}).reason;
    const double off = std::abs(hand.opening() - opening);
    EXPECT_EQ(off < 0.05, opening != 0.5) << hand.opening();
    EXPECT_EQ(reason, opening == 0.5 ? EndReason::kSettled : EndReason::kArrived) << opening;
  }
}

// Openings are shares of the distance.
TEST_F(FingerWatchTest, RejectsAnImpossibleFingerDistance) {
  EnvConfig config = Rc7Env();
  config.robots["robot"].move_groups.find("gripper")->distance->open = 0.05;
  ExpectThrow<SpecError>([&] { Env env(config); },
                         "move_groups.gripper.distance: the fingers are 0.002 m apart when closed "
                         "and 0.090 m when open, not 0.002 and 0.050");
  config = Slides(R"(biasprm="0 -1000 -10")");
  config.grippers["robot"].move_groups.find("gripper")->distance =
      GripperDistance{.closed = 0, .open = 0.2};
  ExpectThrow<SpecError>([&] { Env env(config); }, "m when open, not 0.000 and 0.200");
}

TEST(FingerWatch, WaitsForLinkagesThatPressOnTheirPads) {
  REQUIRE_MENAGERIE("kinova_gen3");
  REQUIRE_MENAGERIE("robotiq_2f85");
  EnvConfig config{.control_mode = ControlMode::kJoints, .relative_to = RelativeTo::kLastStep};
  config.robots["robot"] = Gen3WithTool();
  config.sim.max_convergence_time = 5;
  Env env(config);
  env.Reset({.seed = 1});
  const mjModel* m = env.scene().model();
  for (const double opening : {0.0, 1.0, 0.0}) {
    ASSERT_EQ(env.Step(Numbers{0, 0, 0, 0, 0, 0, 0, opening}).reason, EndReason::kArrived);
    for (int j = 0; j < m->njnt; ++j) {
      if (std::string_view(ElementName(m, mjOBJ_JOINT, j)).find("g_") == std::string_view::npos)
        continue;
      EXPECT_LT(std::abs(env.scene().data()->qvel[m->jnt_dofadr[j]]), 0.05)
          << ElementName(m, mjOBJ_JOINT, j) << " " << opening;
    }
  }
}

}  // namespace
}  // namespace robocell::internal
