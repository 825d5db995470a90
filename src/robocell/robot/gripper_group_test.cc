// Tests grippers: openings, distances, measured and guessed values, held objects, and messages.
#include "robocell/robot/gripper_group.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/base/error.h"
#include "robocell/base/log.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

ActuatedGripper& GripperOf(const Robot& robot) {
  return dynamic_cast<ActuatedGripper&>(robot.gripper());
}

void Simulate(Robot& robot, double seconds) {
  const int steps = static_cast<int>(seconds / robot.scene().timestep());
  for (int i = 0; i < steps; ++i) {
    robot.Update();
    EXPECT_TRUE(robot.Step().ok());
  }
}

MoveGroupConfig& GripperConfig(RobotConfig& config) { return config.move_groups.at("gripper"); }

// The four grippers: twice two slides on a tendon (0..100 and 0..255 percent), two linkages.
struct GripperCase {
  RobotCase robot;
  Interval closed, open;  // ranges of the measured distances
  double ctrl_open;
};

std::vector<GripperCase> Grippers() {
  const std::vector<RobotCase> robots = AllRobots();
  return {{robots[0], {0.0019, 0.0021}, {0.0899, 0.0901}, 100},
          {robots[1], {0.002, 0.0041}, {0.0885, 0.0895}, 0},
          {robots[2], {0, 0.001}, {0.083, 0.087}, 0},
          {robots[3], {0, 0.004}, {0.079, 0.085}, 255}};
}
void PrintTo(const GripperCase& g, std::ostream* out) { *out << g.robot.name; }

class AnyGripper : public ::testing::TestWithParam<GripperCase> {
 protected:
  // Leaves out the distances of its file.
  Robot Unmeasured() {
    RobotConfig config = *GetParam().robot.spec().config;
    GripperConfig(config).distance.reset();
    return RobotAlone(config);
  }
};
INSTANTIATE_TEST_SUITE_P(Robots, AnyGripper, ::testing::ValuesIn(Grippers()),
                         [](const auto& info) { return info.param.robot.name; });

TEST_P(AnyGripper, MeasuresTheSameRangeInAnyState) {
  REQUIRE_ROBOT(GetParam().robot);
  Robot robot = Unmeasured();
  const Interval range = robot.gripper().inter_finger_dist_range();
  EXPECT_GE(range.lower, GetParam().closed.lower);
  EXPECT_LE(range.lower, GetParam().closed.upper);
  EXPECT_GE(range.upper, GetParam().open.lower);
  EXPECT_LE(range.upper, GetParam().open.upper);
  robot.gripper().Close();
  robot.Apply({{"arm", GroupCommand::RelativeJoints({0.5, 0.3, 0, 0.4, 0, 0, 0})}});
  Simulate(robot, 0.3);
  const GripperRange again = GripperOf(robot).Measure();
  EXPECT_EQ(again.distance.closed, range.lower);
  EXPECT_EQ(again.distance.open, range.upper);
  EXPECT_EQ(again.ctrl.at(0).open, GetParam().ctrl_open);
}

TEST_P(AnyGripper, OpensAndClosesByItsOpening) {
  REQUIRE_ROBOT(GetParam().robot);
  Robot robot = Unmeasured();
  GripperGroup& gripper = robot.gripper();
  const Interval range = gripper.inter_finger_dist_range();
  robot.Apply({{"gripper", GroupCommand::Opening(1)}});
  Simulate(robot, 1);
  EXPECT_NEAR(gripper.opening(), 1, 0.01);
  EXPECT_NEAR(gripper.inter_finger_dist(), range.upper, 1e-3);
  EXPECT_TRUE(gripper.is_open());
  EXPECT_FALSE(gripper.is_grasping());
  robot.Apply({{"gripper", GroupCommand::Opening(0.5)}});
  Simulate(robot, 1);
  EXPECT_NEAR(gripper.opening(), 0.5, 0.1) << "linkages are not linear";
  EXPECT_FALSE(gripper.is_open());
  robot.Apply({{"gripper", GroupCommand::Opening(0)}});
  Simulate(robot, 1);
  EXPECT_NEAR(gripper.opening(), 0, 0.01);
  EXPECT_NEAR(gripper.inter_finger_dist(), range.lower, 1e-3);
  EXPECT_FALSE(gripper.is_open());
  EXPECT_FALSE(gripper.is_grasping()) << "fingers that touch each other hold nothing";
}

// A cube between the fingers, held by closing them, then no cube.
TEST_P(AnyGripper, HoldsACubeBetweenItsFingers) {
  REQUIRE_ROBOT(GetParam().robot);
  SceneSpec spec = SceneWith(GetParam().robot.spec());
  spec.robots[0].name = "robot";
  spec.gravity = {0, 0, 0};
  for (const char* name : {"cube", "other"}) spec.objects.push_back(BoxObject(name, {3, 3, 1}));
  Scene scene = Scene::Build(spec);
  Robot robot = Robot::Of(scene, "robot");
  ActuatedGripper& gripper = GripperOf(robot);
  gripper.Open();
  Simulate(robot, 0.5);
  const mjModel* m = scene.model();
  const Eigen::Vector3d middle =
      (Eigen::Vector3d(scene.data()->geom_xpos + 3 * gripper.finger(0).geoms[0]) +
       Eigen::Vector3d(scene.data()->geom_xpos + 3 * gripper.finger(1).geoms[0])) /
      2;
  const Pose hand = scene.body_pose(ElementName(m, mjOBJ_BODY, gripper.hand_body()));
  scene.SetBodyPose("cube", Pose(middle, hand.quaternion()));
  EXPECT_FALSE(gripper.is_grasping());
  gripper.Close();
  Simulate(robot, 0.7);
  EXPECT_TRUE(gripper.is_grasping());
  EXPECT_TRUE(gripper.is_grasping("cube"));
  EXPECT_FALSE(gripper.is_grasping("other"));
  EXPECT_NEAR(gripper.inter_finger_dist(), 0.04, 0.005);
  gripper.Open();
  Simulate(robot, 0.5);
  EXPECT_FALSE(gripper.is_grasping());
}

// Sides are the branches below the hand: parts that a finger carries belong to it, the hand does
// not.
TEST_P(AnyGripper, FingerSidesAreDisjoint) {
  REQUIRE_ROBOT(GetParam().robot);
  const Robot robot = Unmeasured();
  const ActuatedGripper& gripper = GripperOf(robot);
  const mjModel* m = robot.scene().model();
  for (const int geom : gripper.finger(0).side) {
    EXPECT_THAT(gripper.finger(1).side, Not(Contains(geom)));
    EXPECT_NE(m->geom_bodyid[geom], gripper.hand_body());
  }
  for (int i = 0; i < 2; ++i) {
    EXPECT_THAT(gripper.finger(i).side, Contains(gripper.finger(i).geoms[0]));
  }
}

TEST(Gripper, FingerSidesOfALinkageExtendToTheHand) {
  REQUIRE_MENAGERIE("ufactory_xarm7");
  const Robot robot = RobotAlone(XArm7());
  const ActuatedGripper& gripper = GripperOf(robot);
  const mjModel* m = robot.scene().model();
  EXPECT_EQ(ElementName(m, mjOBJ_BODY, gripper.hand_body()), "xarm_gripper_base_link");
  std::vector<std::string> bodies;
  for (const int g : gripper.finger(0).side) {
    bodies.push_back(ElementName(m, mjOBJ_BODY, m->geom_bodyid[g]));
  }
  EXPECT_THAT(bodies, ::testing::Each(::testing::AnyOf("left_outer_knuckle", "left_finger")));
  EXPECT_THAT(bodies, Contains("left_outer_knuckle"));
  const int pad = RequireId(m, mjOBJ_GEOM, "left_finger_pad_1", "");
  EXPECT_THAT(gripper.finger(0).side, Contains(pad)) << "the pad that was not named, too";
}

TEST(Gripper, IsNotMeasuredWithACompleteConfiguration) {
  RobotConfig config = Rc7();
  GripperConfig(config).distance = GripperDistance{0.01, 0.05};
  Robot robot = RobotAlone(config);
  EXPECT_EQ(robot.gripper().inter_finger_dist_range().lower, 0.01);
  EXPECT_EQ(robot.gripper().opening(), 1) << "clamped";
  EXPECT_NEAR(GripperOf(robot).Measure().distance.open, 0.09, 1e-4);
}

TEST(Gripper, KeepsConfiguredDistancesWithGuessedControls) {
  RobotConfig config = Rc7();
  GripperConfig(config).ctrl.reset();
  GripperConfig(config).distance = GripperDistance{0, 0.1};
  Robot robot = RobotAlone(config);
  EXPECT_EQ(robot.gripper().ctrl_for_opening(1), 100);
  EXPECT_EQ(robot.gripper().ctrl_for_opening(0), 0);
  EXPECT_EQ(robot.gripper().inter_finger_dist_range().upper, 0.1);
}

TEST(Gripper, MeasuringIgnoresObstaclesAndOtherRobots) {
  RobotConfig config = Rc7();
  GripperConfig(config).distance.reset();
  const Interval alone = RobotAlone(config).gripper().inter_finger_dist_range();
  SceneSpec spec = SceneWith({.name = "rc7", .config = config});
  const Eigen::Vector3d tcp = RobotAlone(config).tcp_in_world().translation();
  spec.objects.push_back(BoxObject("between", ToVec3(tcp)));
  spec.robots.push_back({.config = config, .prefix = "other_", .pos = {0, 1, 0}});
  const Interval crowded = Robot::Of(Scene::Build(spec), "rc7").gripper().inter_finger_dist_range();
  EXPECT_NEAR(crowded.lower, alone.lower, 1e-9);
  EXPECT_NEAR(crowded.upper, alone.upper, 1e-9);
}

TEST(Gripper, FingersCanBeGeomsBodiesSitesOrTheBodiesOfTwoJoints) {
  RobotConfig config = Rc7();
  MoveGroupConfig& gripper = GripperConfig(config);
  const double pads = RobotAlone(config).gripper().inter_finger_dist();
  gripper.fingers = {{.name = "left_finger"}, {.name = "right_finger"}};
  const double bodies = RobotAlone(config).gripper().inter_finger_dist();
  gripper.fingers = {};
  EXPECT_EQ(RobotAlone(config).gripper().inter_finger_dist(), bodies);
  EXPECT_NEAR(bodies, pads, 0.01);
  for (const char* side : {"left", "right"}) {
    const std::string name = side;
    Edit tip;
    tip.body = ElementRef{.name = name + "_finger"};
    tip.add_site = name + "_tip";
    config.edits.push_back(tip);
    gripper.fingers.push_back({.kind = ElementKind::kSite, .name = name + "_tip"});
  }
  EXPECT_NEAR(RobotAlone(config).gripper().inter_finger_dist(), 0.002 + 2 * 0.044, 1e-9);
}

TEST(Gripper, FindsFingersAtTheEndsOfLinkages) {
  REQUIRE_MENAGERIE("ufactory_xarm7", "kinova_gen3", "robotiq_2f85");
  for (RobotConfig config : {XArm7(), Gen3WithTool()}) {
    MoveGroupConfig& gripper = GripperConfig(config);
    gripper.distance = {};
    const Interval named = RobotAlone(config).gripper().inter_finger_dist_range();
    gripper.fingers = {};
    const Interval found = RobotAlone(config).gripper().inter_finger_dist_range();
    EXPECT_NEAR(found.lower, named.lower, 0.005) << config.name;
    EXPECT_NEAR(found.upper, named.upper, 0.005) << config.name;
    EXPECT_GT(found.upper - found.lower, 0.08) << config.name;
  }
}

TEST(Gripper, ReportsFingersThatCannotBeIdentified) {
  RobotConfig config = Rc7();
  MoveGroupConfig& gripper = GripperConfig(config);
  gripper.fingers = {};
  gripper.joints = {"left_finger_joint"};
  config.home = {};
  config.home_noise = {};
  ExpectThrow<ArgumentError>(
      [&] { RobotAlone(config); },
      "robot 'rc7' / group 'gripper': which are its fingers? Name two geoms, bodies or sites in "
      "`fingers` (they can be guessed only for a gripper with two joints; this one has 1). Bodies "
      "that move at its joints, and those that carry them: hand, left_finger");
  gripper.joints = {};
  ExpectThrow<ArgumentError>(
      [&] { RobotAlone(config); },
      "(they can be guessed only for a gripper with two joints; this one has none: list them in "
      "`joints`). Its joints may be: left_finger_joint, right_finger_joint");
  gripper.joints = {"left_finger_joint"};
  gripper.fingers = {{.name = "left_finger_pad"}, {.name = "left_finger_blade"}};
  ExpectThrow<ArgumentError>(
      [&] { RobotAlone(config); },
      "group 'gripper': the fingers geom 'left_finger_pad' and geom 'left_finger_blade' are parts "
      "of one rigid body, so nothing moves between them; name one element of each finger");
}

TEST(Gripper, ReportsSwappedOpenAndClosed) {
  RobotConfig config = Rc7();
  GripperConfig(config).ctrl = GripperCtrl{.open = 0, .closed = 100};
  GripperConfig(config).distance.reset();
  Robot robot = RobotAlone(config);
  ExpectThrow<ArgumentError>(
      [&] { robot.gripper().opening(); },
      "robot 'rc7' / group 'gripper': the fingers are 0.0020 m apart at ctrl.open = 0 and 0.0900 m "
      "at ctrl.closed = 100; open and closed are swapped");
}

// It closes with 5 N and opens with less than friction requires.
RobotConfig WithStickyGripper(ModelFolder& folder, const std::string& arm) {
  constexpr const char* kSticky = R"(<compiler angle="radian"/><worldbody><body name="palm">
    <geom size=".01" mass=".1"/>
    <body name="left" pos="0 .05 .05"><joint name="l" type="slide" axis="0 1 0" range="-.04 0"
      limited="true" frictionloss="1"/><geom type="box" size=".01 .004 .02" mass=".05"/></body>
    <body name="right" pos="0 -.05 .05"><joint name="r" type="slide" axis="0 -1 0" range="-.04 0"
      limited="true" frictionloss="1"/><geom type="box" size=".01 .004 .02" mass=".05"/></body>
    </body></worldbody><equality><joint joint1="l" joint2="r"/></equality><actuator>
    <position name="grip" joint="l" kp="200" kv="5" ctrlrange="-.04 0" forcerange="-5 .5"/>
    </actuator>)";
  RobotConfig config = ArmConfig(folder.Write("arm", arm));
  config.attachments.push_back({.mjcf_path = folder.Write("sticky", kSticky),
                                .attach_to = {AttachKind::kSite, "flange"},
                                .prefix = "g_"});
  config.move_groups["gripper"] = {
      .kind = MoveGroupKind::kGripper, .joints = {"g_l", "g_r"}, .actuators = {"g_grip"}};
  return config;
}

TEST(Gripper, ReportsFingersThatDoNotReturn) {
  ModelFolder folder;
  RobotConfig config = WithStickyGripper(folder, kTwoJointArm);
  for (const bool stated : {false, true}) {
    if (stated) GripperConfig(config).ctrl = GripperCtrl{.open = 0, .closed = -0.04};
    Robot robot = RobotAlone(config);
    ExpectThrow<ArgumentError>(
        [&] { robot.gripper().opening(); },
        "group 'gripper': the fingers do not come back: control 0 brings them 0.0920 m apart from "
        "home, "
        "and leaves them 0.02");
    ExpectThrow<ArgumentError>([&] { robot.gripper().opening(); },
                               ". Nothing touches them: is the actuator too weak to move them?");
  }
}

// No force helps against it.
TEST(Gripper, ReportsAKvThatBlocksTheFingers) {
  RobotConfig config = Rc7();
  GripperConfig(config).distance.reset();
  config.edits.push_back({.actuator = ElementRef{.name = "gripper"}, .kv = 4e6});
  const std::string message = ExpectThrow<ArgumentError>(
      [&] { RobotAlone(config).gripper().opening(); },
      "The kv of its servo 'gripper', 4e+06, is too large for its kp of ");
  const size_t from = message.find("edits: [{actuator: 'gripper', kv: ");
  ASSERT_NE(from, std::string::npos) << message;
  config.edits.back().kv = std::stod(message.substr(from + 34));
  EXPECT_GT(RobotAlone(config).gripper().inter_finger_dist_range().upper, 0.05);
}

// At home a ball of the upper arm is at the place of the palm, and stops both fingers.
TEST(Gripper, ReportsContactsOfFingersThatDoNotReturn) {
  const std::string ball = R"(<geom name="ball" type="sphere" size=".034" pos="-.0779 0 .4842"
      contype="1" conaffinity="1"/>)";
  std::string arm = kTwoJointArm;
  arm.insert(arm.find("<body name=\"fore\""), ball);
  ModelFolder folder;
  const std::string message = ExpectThrow<ArgumentError>(
      [&] { RobotAlone(WithStickyGripper(folder, arm)).gripper().opening(); },
      "the fingers do not come back: ");
  EXPECT_THAT(message, HasSubstr("Meanwhile 'upper' and 'g_left', 'upper' and 'g_right' touch. Do "
                                 "they overlap or catch on each other (exclude in the model the "
                                 "pairs that may overlap, or choose another `home`), or is the "
                                 "actuator too weak to move the fingers?"));
}

// Fingers that approach the target of their servo to 1/e in `seconds`.
RobotConfig WithSlowGripper(ModelFolder& folder, double seconds, const std::string& actuator) {
  const std::string hand = fmt::format(
      R"(<compiler angle="radian"/><worldbody><body name="palm">
    <geom size=".01" mass=".1"/>
    <body name="left" pos="0 .005 .05"><joint name="l" type="slide" axis="0 1 0" range="0 .04"
      limited="true" damping="{0}"/><geom type="box" size=".01 .004 .02" mass=".05"/></body>
    <body name="right" pos="0 -.005 .05"><joint name="r" type="slide" axis="0 -1 0" range="0 .04"
      limited="true" damping="{0}"/><geom type="box" size=".01 .004 .02" mass=".05"/></body>
    </body></worldbody><equality><joint joint1="l" joint2="r"/></equality><actuator>{1}
    </actuator>)",
      500 * seconds, actuator);
  RobotConfig config = ArmConfig(folder.Write("arm", kTwoJointArm));
  config.attachments.push_back({.mjcf_path = folder.Write("hand", hand),
                                .attach_to = {AttachKind::kSite, "flange"},
                                .prefix = "g_"});
  config.move_groups["gripper"] = {
      .kind = MoveGroupKind::kGripper, .joints = {"g_l", "g_r"}, .actuators = {"g_grip"}};
  return config;
}

TEST(Gripper, MeasuresSlowFingersAtRest) {
  constexpr const char* kServo = R"(<position name="grip" joint="l" kp="1000" ctrlrange="0 .04"/>)";
  for (const double seconds : {0.05, 2.0}) {
    ModelFolder folder;
    const Interval range =
        RobotAlone(WithSlowGripper(folder, seconds, kServo)).gripper().inter_finger_dist_range();
    EXPECT_NEAR(range.lower, 0.002, 0.0025) << seconds;
    EXPECT_NEAR(range.upper, 0.082, 0.0025) << seconds;
  }
}

TEST(Gripper, RejectsFingersThatDoNotComeToRest) {
  constexpr const char* kServo = R"(<position name="grip" joint="l" kp="1000" ctrlrange="0 .04"/>)";
  ModelFolder folder;
  RobotConfig config = WithSlowGripper(folder, 30, kServo);
  for (const bool stated : {false, true}) {
    if (stated) GripperConfig(config).distance = GripperDistance{.closed = 0.002, .open = 0.082};
    Robot robot = RobotAlone(config);
    ExpectThrow<ArgumentError>(
        [&] { GripperOf(robot).Measure(); },
        "group 'gripper': the fingers do not come to rest: 20 s after control 0.04 they go between "
        "0.0");
  }
}

TEST(Gripper, ExplainsThatAVelocityServoHoldsNoOpening) {
  ModelFolder folder;
  Robot robot = RobotAlone(WithSlowGripper(
      folder, 1, R"(<velocity name="grip" joint="l" kv="1000" ctrlrange="-.002 .002"/>)"));
  ExpectThrow<ArgumentError>([&] { robot.gripper().opening(); },
                             "Its actuator 'g_grip' is a velocity servo: its control is a speed, "
                             "which holds no opening. Drive the fingers with a position servo or a "
                             "motor");
}

// Fingers with a servo each, whose ranges are mirrored, and a thumb that does not change the finger
// distance: it follows the first servo. `first` and `second` are the slides' ranges.
RobotConfig WithTwoServos(ModelFolder& folder, const char* first_axis, const char* first,
                          const char* second_axis, const char* second) {
  const std::string hand = fmt::format(
      R"(<compiler angle="radian"/><worldbody><body name="palm">
    <geom size=".01" mass=".1"/>
    <body name="left" pos="0 .005 .05"><joint name="l" type="slide" axis="{0}" range="{1}"
      limited="true" damping="5"/><geom type="box" size=".01 .004 .02" mass=".05"/></body>
    <body name="right" pos="0 -.005 .05"><joint name="r" type="slide" axis="{2}" range="{3}"
      limited="true" damping="5"/><geom type="box" size=".01 .004 .02" mass=".05"/></body>
    <body name="thumb" pos=".2 0 .05"><joint name="t" axis="0 1 0" damping="1"/>
      <geom size=".01" mass=".05"/></body>
    </body></worldbody><actuator>
    <position name="left" joint="l" kp="500" kv="10" ctrlrange="{1}"/>
    <position name="right" joint="r" kp="500" kv="10" ctrlrange="{3}"/>
    <position name="thumb" joint="t" kp="1" kv=".1" ctrlrange="0 1"/></actuator>)",
      first_axis, first, second_axis, second);
  RobotConfig config = ArmConfig(folder.Write("arm", kTwoJointArm));
  config.attachments.push_back({.mjcf_path = folder.Write("hand", hand),
                                .attach_to = {AttachKind::kSite, "flange"},
                                .prefix = "g_"});
  config.move_groups["gripper"] = {.kind = MoveGroupKind::kGripper,
                                   .joints = {"g_l", "g_r"},
                                   .actuators = {"g_left", "g_right", "g_thumb"}};
  return config;
}

// The actuators move on for a long time after the fingers have met.
TEST(Gripper, ScalesTheOpeningToTheMeasuredRange) {
  ModelFolder folder;
  const RobotConfig config = WithTwoServos(folder, "0 1 0", "-.02 .02", "0 -1 0", "-.02 .02");
  Robot robot = RobotAlone(config);
  GripperGroup& gripper = robot.gripper();
  EXPECT_EQ(gripper.ctrl_for_opening(1), 0.02);
  EXPECT_EQ(gripper.ctrl_for_opening(0), -0.02) << "closes with all its force";
  double before = -1;
  for (const double opening : {0.0, 0.02, 0.05, 0.25, 0.5, 0.75, 1.0}) {
    EXPECT_GT(gripper.ctrl_for_opening(opening), before);
    before = gripper.ctrl_for_opening(opening);
    robot.Apply({{"gripper", GroupCommand::Opening(opening)}});
    Simulate(robot, 1);
    EXPECT_NEAR(gripper.opening(), opening, 0.05);
    // The opening read back from a control is the commanded one.
    robot.controller("gripper").Reset();
    EXPECT_NEAR(robot.controller("gripper").target()[0], opening, 1e-6);
  }
  RobotConfig stated = config;
  GripperConfig(stated).actuators = {"g_left", "g_right"};
  GripperConfig(stated).ctrl = GripperCtrl{.open = 0.02, .closed = -0.02};
  EXPECT_DOUBLE_EQ(RobotAlone(stated).gripper().ctrl_for_opening(0.5), 0)
      << "of the controls, which the file says";
}

TEST(Gripper, EachServoOpensByItsOwnRange) {
  struct Hand {
    const char *first_axis, *first, *second_axis, *second;
    std::array<double, 3> open, closed;
  };
  const Hand hands[] = {
      {"0 1 0", "0 .04", "0 1 0", "-.04 0", {.04, -.04, 1}, {0, 0, 0}},
      {"0 -1 0", "-.04 0", "0 -1 0", "0 .04", {-.04, .04, 0}, {0, 0, 1}},
      {"0 1 0", "0 .04", "0 -1 0", "0 .03", {.04, .03, 1}, {0, 0, 0}},
  };
  for (const Hand& hand : hands) {
    ModelFolder folder;
    Robot robot = RobotAlone(
        WithTwoServos(folder, hand.first_axis, hand.first, hand.second_axis, hand.second));
    GripperGroup& gripper = robot.gripper();
    const Interval range = gripper.inter_finger_dist_range();
    EXPECT_NEAR(range.lower, 0.002, 1e-3);
    EXPECT_NEAR(range.upper, 0.002 + std::abs(hand.open[0]) + std::abs(hand.open[1]), 1e-3);
    EXPECT_EQ(gripper.ctrl_for_opening(1), hand.open[0]);
    for (const double opening : {1.0, 0.25, 0.0}) {
      robot.Apply({{"gripper", GroupCommand::Opening(opening)}});
      Simulate(robot, 1);
      for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(gripper.ctrl()[i], hand.closed[i] + opening * (hand.open[i] - hand.closed[i]),
                    1e-12);
      }
      EXPECT_NEAR(gripper.opening(), opening, 0.02);
    }
    gripper.Open();
    EXPECT_THAT(gripper.ctrl(), ::testing::ElementsAreArray(hand.open));
  }
}

TEST(Gripper, NamesAServoWithoutARange) {
  ModelFolder folder;
  RobotConfig config = WithTwoServos(folder, "0 1 0", "0 .04", "0 1 0", "-.04 0");
  config.attachments[0].mjcf_path = folder.Write("free", [&] {
    std::string hand = R"(<worldbody><body name="palm"><geom size=".01" mass=".1"/>
      <body name="left"><joint name="l" type="slide"/><geom size=".01"/></body>
      <body name="right"><joint name="r" type="slide"/><geom size=".01"/></body>
      </body></worldbody><actuator><position name="left" joint="l" ctrlrange="0 .04"/>
      <position name="right" joint="r"/></actuator>)";
    return hand;
  }());
  GripperConfig(config).actuators = {"g_left", "g_right"};
  Robot robot = RobotAlone(config);
  ExpectThrow<ArgumentError>(
      [&] { robot.gripper().opening(); },
      "group 'gripper': actuator 'g_right' has no control range; give `ctrl: {open: ..., closed: "
      "...}`");
}

TEST(Gripper, ReportsFingersThatDoNotMove) {
  RobotConfig config = Rc7();
  GripperConfig(config).ctrl = GripperCtrl{.open = 100, .closed = 99.999};
  GripperConfig(config).distance.reset();
  Robot robot = RobotAlone(config);
  ExpectThrow<ArgumentError>(
      [&] { robot.gripper().opening(); },
      "the finger distance stays at 0.0900 m between control 100 and 99.999; "
      "are `fingers` and `ctrl` right? Nothing touches them: is the actuator too weak to move "
      "them?");
}

// Two hooks that cross at their roots, whatever their tips do.
TEST(Gripper, NamesOverlappingGeomsOfTheFingers) {
  ModelFolder folder;
  RobotConfig config = WithTwoServos(folder, "0 1 0", "0 .04", "0 1 0", "-.04 0");
  config.attachments[0].mjcf_path = folder.Write("hooks", R"(
      <worldbody><body name="palm"><geom size=".01" mass=".1"/>
      <body name="left" pos="0 .01 0"><joint name="l" type="slide" axis="0 1 0" range="0 .04"
        damping="5"/><geom name="l_root" type="box" size=".01 .06 .01"/>
      <geom name="l_tip" type="box" size=".01 .005 .01" pos="0 0 .05"/></body>
      <body name="right" pos="0 -.01 0"><joint name="r" type="slide" axis="0 1 0" range="-.04 0"
        damping="5"/><geom type="box" size=".01 .06 .01"/>
      <geom name="r_tip" type="box" size=".01 .005 .01" pos="0 0 .05"/></body>
      </body></worldbody><contact><exclude body1="left" body2="right"/></contact>
      <actuator><position name="left" joint="l" ctrlrange="0 .04" kp="500" kv="10"/>
      <position name="right" joint="r" ctrlrange="-.04 0" kp="500" kv="10"/></actuator>)");
  GripperConfig(config).actuators = {"g_left", "g_right"};
  ExpectThrow<ArgumentError>(
      [&] { RobotAlone(config).gripper().opening(); },
      "the finger distance stays at 0.0000 m between control [0.04, 0] and [0, -0.04]; are "
      "`fingers` and `ctrl` right? geom 'g_l_root' of 'g_left' and geom");
  GripperConfig(config).fingers = {{.name = "g_l_tip"}, {.name = "g_r_tip"}};
  EXPECT_NEAR(RobotAlone(config).gripper().inter_finger_dist_range().upper, 0.09, 1e-3);
}

// Fingers of sixty metres always overlap.
TEST(Gripper, SuspectsAFingerMeshInMillimetres) {
  ModelFolder folder;
  RobotConfig config = WithTwoServos(folder, "0 1 0", "0 .04", "0 1 0", "-.04 0");
  config.attachments[0].mjcf_path = folder.Write("large", R"(<asset><mesh name="pad"
      vertex="-8 0 0  8 0 0  8 20 0  -8 20 0  -8 0 60  8 0 60  8 20 60  -8 20 60"/></asset>
      <worldbody><body name="palm"><geom size=".01" mass=".1"/>
      <body name="left" pos="0 .01 0"><joint name="l" type="slide" axis="0 1 0" range="0 .04"/>
      <geom type="mesh" mesh="pad" mass=".1"/></body>
      <body name="right" pos="0 -.01 0"><joint name="r" type="slide" axis="0 1 0" range="-.04 0"/>
      <geom type="mesh" mesh="pad" mass=".1"/></body>
      </body></worldbody><actuator><position name="left" joint="l" ctrlrange="0 .04"/>
      <position name="right" joint="r" ctrlrange="-.04 0"/></actuator>)");
  GripperConfig(config).actuators = {"g_left", "g_right"};
  Robot robot = RobotAlone(config);
  ExpectThrow<ArgumentError>([&] { robot.gripper().opening(); },
                             "are `fingers` and `ctrl` right? The mesh 'g_pad' of 'g_left' is 60 m "
                             "large. Is it drawn in millimetres? Then give its <mesh> "
                             "scale=\"0.001 0.001 0.001\"");
}

// Contacts are soft: a light and fast object crosses a thin finger before they stop it.
TEST(Gripper, WarnsAboutPenetratingLightFingersWithARemedy) {
  ModelFolder folder;
  RobotConfig config;
  config.name = "hand";
  config.model = folder.Write("hand", R"(<compiler angle="radian"/><worldbody><body name="palm">
      <geom size=".01" mass=".1"/>
      <body name="left" pos="0 .005 .05"><joint name="l" type="slide" axis="0 1 0"
        range="-.02 .02" damping="5"/><geom type="box" size=".01 .004 .02" mass=".05"/></body>
      <body name="right" pos="0 -.005 .05"><joint name="r" type="slide" axis="0 -1 0"
        range="-.02 .02" damping="5"/><geom type="box" size=".01 .004 .02" mass=".05"/></body>
      </body></worldbody><actuator>
      <position name="left" joint="l" kp="500" kv="10" ctrlrange="-.02 .02"/>
      <position name="right" joint="r" kp="500" kv="10" ctrlrange="-.02 .02"/></actuator>)");
  config.move_groups["gripper"] = {.kind = MoveGroupKind::kGripper,
                                   .joints = {"l", "r"},
                                   .actuators = {"left", "right"},
                                   .ctrl = GripperCtrl{.open = 0.02, .closed = -0.02}};
  std::vector<std::string> warnings;
  const ScopedLogSink sink([&](LogLevel, std::string_view text) { warnings.emplace_back(text); });
  EXPECT_GT(RobotAlone(config).gripper().inter_finger_dist_range().lower, 0.01);
  EXPECT_THAT(warnings,
              ::testing::Contains(::testing::HasSubstr(
                  "robot 'hand': 'left' and 'right' pass through each other on the way to control "
                  "[-0.02, -0.02]: they are too light and too fast for their contact to stop them "
                  "with a timestep of 0.002 s, so the measured distance is wrong. Slow them down "
                  "with damping, in their model or by edits: [{joint: 'l', damping: 100}, {joint: "
                  "'r', damping: 100}], or use a smaller timestep")));
  warnings.clear();
  for (const char* joint : {"l", "r"})
    config.edits.push_back({.joint = ElementRef{.name = joint}, .damping = 100});
  const Interval range = RobotAlone(config).gripper().inter_finger_dist_range();
  EXPECT_NEAR(range.lower, 0, 1e-6);
  EXPECT_NEAR(range.upper, 0.042, 1e-3);
  EXPECT_THAT(warnings, ::testing::IsEmpty());
}

TEST(Gripper, RejectsNonFiniteOpeningsAndClampsOthers) {
  Robot robot = RobotAlone(Rc7());
  ExpectThrow<ArgumentError>([&] { robot.gripper().SetOpening(NAN); },
                             "robot 'rc7' / group 'gripper': opening cannot be nan; it goes from 0 "
                             "(closed) to 1 (open)");
  robot.gripper().SetOpening(7);
  EXPECT_EQ(robot.scene().actuator_ctrl("gripper"), 100);
  ExpectThrow<NotFoundError>([&] { robot.gripper().is_grasping("cub"); },
                             "robot 'rc7' / group 'gripper': no body 'cub'");
}

TEST(GripperRoot, IsTheTcpOfItsArmByDefault) {
  RobotConfig config = Rc7();
  ASSERT_TRUE(config.move_groups["arm"].leaf);
  GripperConfig(config).leaf.reset();
  const Robot robot = RobotAlone(config);
  const MoveGroup& gripper = robot.gripper();
  EXPECT_TRUE(gripper.root_frame_to_world().is_close(robot.tcp_in_world(), 1e-12, 1e-12));
  EXPECT_FALSE(gripper.leaf_frame_to_world().is_close(robot.tcp_in_world(), 1e-3, 1e-3));
}

TEST(GripperRoot, IsItsLeafFrameUnlessConfigured) {
  RobotConfig config = Rc7();
  const Robot robot = RobotAlone(config);
  const MoveGroup& gripper = robot.gripper();
  EXPECT_TRUE(gripper.root_frame_to_world().is_close(gripper.leaf_frame_to_world(), 1e-12, 1e-12));
  EXPECT_TRUE(gripper.leaf_frame_to_root().is_close(Pose(), 1e-12, 1e-12));
  EXPECT_TRUE(gripper.leaf_frame_to_world().is_close(robot.tcp_in_world(), 1e-12, 1e-12));
  GripperConfig(config).root = ElementRef{.name = config.root_body};
  const Robot other = RobotAlone(config);
  EXPECT_TRUE(other.gripper().root_frame_to_world().is_close(other.base_in_world(), 1e-12, 1e-12));
}

TEST_P(AnyGripper, ReadsItsOpeningFromItsJointRange) {
  RobotConfig config = *GetParam().robot.spec().config;
  if (GripperConfig(config).joints.empty()) return;
  GripperConfig(config).joint_range = GripperJointRange{.open = -0.3, .closed = 0.9};
  Robot robot = RobotAlone(config);
  for (const double target : {0.0, 0.5, 1.0}) {
    GripperOf(robot).SetOpening(target);
    Simulate(robot, 0.3);
    const double q = robot.gripper().joint_pos()[0];
    EXPECT_NEAR(robot.gripper().opening(), std::clamp((q - 0.9) / -1.2, 0.0, 1.0), 1e-12);
  }
}

}  // namespace
}  // namespace robocell::internal
