#include "robocell/robot/validate_config.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <utility>

#include "robocell/robot/testing/hands.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/long_form.h"

namespace robocell::internal {
namespace {

using ::testing::HasSubstr;

// Returns the problem of a configuration; "" if it is valid.
std::string Wrong(const RobotConfig& config) {
  Problems problems(config.locations);
  ValidateConfig(RobotAlone(config), problems);
  return problems.empty() ? "" : problems.Text("robot");
}

TEST(ValidateConfig, ShippedFilesMatchTheirModels) {
  EXPECT_EQ(Wrong(Rc7()), "");
  for (const auto& [file, model] : {std::pair{"xarm7.yaml", "ufactory_xarm7"},
                                    {"panda.yaml", "franka_emika_panda"},
                                    {"fr3_2f85.yaml", "franka_fr3"},
                                    {"gen3_2f85.yaml", "kinova_gen3"}}) {
    // The short form tries a robot whose gripper is in its model and one with a gripper beside it.
    const bool is_short =
        model == std::string_view("ufactory_xarm7") || model == std::string_view("franka_fr3");
    if (!LongForm() && !is_short) continue;
    REQUIRE_MENAGERIE(model);
    EXPECT_EQ(Wrong(LoadShipped(std::string("examples/") + file)), "") << file;
  }
}

TEST(ValidateConfig, ReportsTheLineOfAWrongFingerDistance) {
  RobotConfig config = Rc7();
  config.move_groups.find("gripper")->distance->closed = 0.02;
  const std::string text = Wrong(config);
  EXPECT_THAT(text, HasSubstr("rc7.yaml:15:"));
  EXPECT_THAT(text, HasSubstr("move_groups.gripper.distance: the fingers are 0.002 m apart when "
                              "closed and 0.090 m when open, not 0.020 and 0.090: correct it, or "
                              "leave `distance` out to have it measured"));
}

TEST(ValidateConfig, ReportsAWrongGripperJointRange) {
  RobotConfig config = Rc7();
  Maybe<GripperJointRange>& range = config.move_groups.find("gripper")->joint_range;
  for (const auto& good : {GripperJointRange{.open = 0.044, .closed = 0},
                           GripperJointRange{.open = 0.03, .closed = 0.01},
                           GripperJointRange{.open = 0.06, .closed = -0.01}}) {
    range = good;
    EXPECT_EQ(Wrong(config), "") << good.open;
  }
  range = GripperJointRange{.open = 0, .closed = 0.044};
  EXPECT_THAT(Wrong(config), HasSubstr("open and closed are swapped; exchange them, or leave "
                                       "`joint_range` out to read it from the fingers"));
  for (const auto& wrong :
       {GripperJointRange{.open = 6, .closed = 5}, GripperJointRange{.open = 0.8, .closed = 0}}) {
    range = wrong;
    EXPECT_THAT(Wrong(config),
                HasSubstr("move_groups.gripper.joint_range: joint 'left_finger_joint' is at 0.04"));
    EXPECT_THAT(Wrong(config), HasSubstr("correct it, or leave `joint_range` out"));
  }
}

TEST(ValidateConfig, NamesASpringThatBlocksTheGripper) {
  ModelFolder folder;
  std::string xml = kTwoFingers;
  const std::string joint = "name=\"left_slide\"";
  xml.replace(xml.find(joint), joint.size(), joint + " stiffness=\"1e9\" springref=\"0.03\"");
  RobotConfig config = TwoFingerHand(folder, {});
  config.model = folder.Write("stiff", xml);
  config.move_groups.find("gripper")->distance = GripperDistance{.closed = 0, .open = 0.07};
  EXPECT_THAT(Wrong(config),
              HasSubstr("the stiffness 1e+09 of joint 'left_slide' is too high for"));
}

TEST(ValidateConfig, ReportsAGripperThatCannotBeMeasured) {
  RobotConfig config = Rc7();
  std::swap(config.move_groups.find("gripper")->ctrl->open,
            config.move_groups.find("gripper")->ctrl->closed);
  EXPECT_THAT(Wrong(config), HasSubstr("open and closed are swapped"));
}

// The first check measures the gripper.
TEST(ValidateConfig, NamesTheGainThatMakesAGripperFail) {
  RobotConfig config = Rc7();
  config.edits.push_back({.actuator = ElementRef{.name = "gripper"}, .kp = 5e9});
  EXPECT_THAT(Wrong(config),
              HasSubstr("or is its joint too slow for its actuator? The simulation cannot follow a "
                        "gain: "));
  EXPECT_THAT(Wrong(config), HasSubstr("the gain 5e+09 of servo 'gripper' is too high for tendon "
                                       "'finger_opening', which moves 0.32 kg"));
  config = Rc7();
  config.edits.push_back({.actuator = ElementRef{.name = "servo1"},
                          .forcerange = Vec2{-1e9, 1e9},
                          .kp = 5e9,
                          .kv = 1});
  EXPECT_THAT(Wrong(config),
              HasSubstr("(engine warnings: 1 x bad number in qacc). The simulation cannot follow a "
                        "gain: "));
  EXPECT_THAT(Wrong(config), HasSubstr("rc7.xml:199: robot 'rc7': the gain 5e+09 of servo "
                                       "'servo1' is too high for joint 'joint1'"));
  config.move_groups.find("gripper")->distance.reset();
  ExpectThrow<EngineError>([&] { RobotAlone(config).gripper().opening(); },
                           "of servo 'servo1' is too high for joint 'joint1'");
}

TEST(ValidateConfig, ReportsABaseWiderThanTheReach) {
  RobotConfig config = Rc7();
  config.base.size = Vec3{22, 22, 25};
  const std::string text = Wrong(config);
  EXPECT_THAT(text, HasSubstr("base.size: on a box of 22 x 22 x 25 m the robot reaches nothing"));
  EXPECT_THAT(text, HasSubstr("are in metres"));
}

TEST(ValidateConfig, ReportsAReachBeyondTheArm) {
  RobotConfig config = Rc7();
  const double measured = RobotAlone(config).reach();
  config.reach = measured;
  EXPECT_EQ(Wrong(config), "");
  config.reach = 0.5;  // less than the real one: only that may be used
  EXPECT_EQ(Wrong(config), "");
  for (const double wrong : {9.0, 0.1}) {
    config.reach = wrong;
    EXPECT_THAT(Wrong(config), HasSubstr(fmt::format(
                                   "reach: the TCP gets {:.2f} m away from the root body, not {:g} "
                                   "m: correct it, or leave `reach` out to have it measured",
                                   measured, wrong)));
  }
}

}  // namespace
}  // namespace robocell::internal
