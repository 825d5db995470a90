// Tests hands with many joints: named poses, each actuator with its own open and closed control.
#include "robocell/robot/hand_pose.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/log.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::Pointwise;
using Values = std::vector<double>;

// A thumb against two fingers, of two hinges each: positive angles close them.
constexpr const char* kHand = R"(<compiler angle="radian"/>
  <default><joint damping=".05" armature=".001" range="-1 1"/><position kp="3" kv=".1"/>
    <geom type="capsule" size=".008" mass=".02"/></default>
  <worldbody><body name="palm" pos="0 0 .3"><geom type="box" size=".04 .05 .01" pos="0 0 -.02" mass=".3"/>
    <site name="grasp" pos="0 0 .07"/>
    <body name="thumb" pos="0 -.04 0"><joint name="t1" axis="-1 0 0"/><geom fromto="0 0 0 0 0 .04"/>
      <body name="thumb_tip" pos="0 0 .04"><joint name="t2" axis="-1 0 0"/><geom fromto="0 0 0 0 0 .04"/></body></body>
    <body name="index" pos=".015 .04 0"><joint name="i1" axis="1 0 0"/><geom fromto="0 0 0 0 0 .04"/>
      <body name="index_tip" pos="0 0 .04"><joint name="i2" axis="1 0 0"/><geom fromto="0 0 0 0 0 .04"/></body></body>
    <body name="middle" pos="-.015 .04 0"><joint name="m1" axis="1 0 0"/><geom fromto="0 0 0 0 0 .04"/>
      <body name="middle_tip" pos="0 0 .04"><joint name="m2" axis="1 0 0"/><geom fromto="0 0 0 0 0 .04"/></body></body>
  </body></worldbody>
  <actuator><position name="thumb_1" joint="t1" ctrlrange="-1 1"/>
    <position name="thumb_2" joint="t2" ctrlrange="-1 1"/>
    <position name="index_1" joint="i1" ctrlrange="-1 1"/>
    <position name="index_2" joint="i2" ctrlrange="-1 1"/>
    <position name="middle_1" joint="m1" gear="2" ctrlrange="-2 2"/>
    <motor name="middle_2" joint="m2" ctrlrange="-.05 .05"/></actuator>)";

class HandPose : public ::testing::Test {
 protected:
  RobotConfig Config() {
    MoveGroupConfig hand{
        .kind = MoveGroupKind::kGripper,
        .joints = {"t1", "t2", "i1", "i2", "m1", "m2"},
        .actuators = {"thumb_1", "thumb_2", "index_1", "index_2", "middle_1", "middle_2"},
        .leaf = ElementRef{.name = "grasp"},
        .fingers = {{.name = "thumb_tip"}, {.name = "index_tip"}, {.name = "middle_tip"}}};
    hand.poses["open"] = {{"thumb_1", -0.3}, {"index_1", -0.3}, {"m1", -0.3}};
    hand.poses["closed"] = {{"thumb_1", 0.3}, {"thumb_2", 0.3}, {"index_1", 0.3},
                            {"index_2", 0.3}, {"m1", 0.3},      {"middle_2", 0.02}};
    hand.poses["pinch"] = {{"t1", 0.3}, {"t2", 0.3}, {"i1", 0.3}, {"i2", 0.3}};
    hand.poses["wave"] = {{"index_1", -0.8}, {"middle_1", -1.2}};
    RobotConfig config{.name = "hand", .model = folder_.Write("hand", kHand)};
    config.move_groups["hand"] = hand;
    config.gravcomp = true;
    return config;
  }

  static void Simulate(Robot& robot, double seconds) {
    for (double end = robot.scene().time() + seconds; robot.scene().time() < end;) {
      robot.Update();
      ASSERT_TRUE(robot.Step().ok());
    }
  }

  ModelFolder folder_;
};

const Values kOpen = {-0.3, 0, -0.3, 0, -0.6, 0};
const Values kClosed = {0.3, 0.3, 0.3, 0.3, 0.6, 0.02};
const Values kPinch = {0.3, 0.3, 0.3, 0.3, -0.6, 0};

TEST_F(HandPose, OpeningsBlendTheControlsOfEachActuator) {
  Robot robot = RobotAlone(Config());
  GripperGroup& hand = robot.gripper();
  EXPECT_THAT(hand.pose_names(), ElementsAre("open", "closed", "pinch", "wave"));
  EXPECT_EQ(hand.closing_pose(), "closed");
  for (const double opening : {1.0, 0.75, 0.2, 0.0}) {
    robot.Apply({{"hand", GroupCommand::Opening(opening)}});
    robot.Update();
    const Values ctrl = hand.ctrl();
    for (size_t i = 0; i < ctrl.size(); ++i)
      EXPECT_NEAR(ctrl[i], kClosed[i] + opening * (kOpen[i] - kClosed[i]), 1e-12) << i;
  }
}

TEST_F(HandPose, TheFingersMeetInTheClosingPose) {
  Robot robot = RobotAlone(Config());
  GripperGroup& hand = robot.gripper();
  const Interval range = hand.inter_finger_dist_range();
  EXPECT_LT(range.lower, 0.004);
  EXPECT_GT(range.upper, 0.08);
  hand.Close();
  Simulate(robot, 1);
  EXPECT_NEAR(hand.opening(), 0, 0.05);
  EXPECT_NEAR(hand.inter_finger_dist(), range.lower, 1e-3) << "as it was measured";
  hand.Open();
  Simulate(robot, 1);
  EXPECT_NEAR(hand.opening(), 1, 0.02);
  EXPECT_TRUE(hand.is_open());
}

TEST_F(HandPose, AnotherPoseIsTheClosingPoseUntilTheNextReset) {
  Robot robot = RobotAlone(Config());
  GripperGroup& hand = robot.gripper();
  hand.MoveToPose("pinch");
  EXPECT_EQ(hand.closing_pose(), "pinch");
  Simulate(robot, 1);
  EXPECT_THAT(hand.ctrl(), Pointwise(DoubleNear(1e-12), kPinch)) << "the controller keeps it";
  const Values q = hand.joint_pos();
  EXPECT_NEAR(q[4], -0.3, 0.01) << "the middle finger stays open";
  EXPECT_NEAR(hand.opening(), 0, 0.05);
  robot.Apply({{"hand", GroupCommand::Opening(0.5)}});
  robot.Update();
  const Values half = hand.ctrl();
  for (size_t i = 0; i < half.size(); ++i)
    EXPECT_NEAR(half[i], (kPinch[i] + kOpen[i]) / 2, 1e-12) << i;
  hand.MoveToPose("open");
  EXPECT_EQ(hand.closing_pose(), "pinch");
  EXPECT_THAT(hand.ctrl(), Pointwise(DoubleNear(1e-12), kOpen));
  robot.scene().Reset();
  EXPECT_EQ(hand.closing_pose(), "closed");
  hand.Close();
  EXPECT_THAT(hand.ctrl(), Pointwise(DoubleNear(1e-12), kClosed));
}

std::vector<std::string> WarningsOf(const std::function<void()>& work) {
  std::vector<std::string> texts;
  const ScopedLogSink sink([&](LogLevel level, std::string_view text) {
    if (level == LogLevel::kWarn) texts.emplace_back(text);
  });
  work();
  return texts;
}

std::string Exchanged(std::string text, const std::string& old, const std::string& by) {
  return text.replace(text.find(old), old.size(), by);
}

// Its opening is the commanded one, because no distance of fingers measures it.
TEST_F(HandPose, APoseNeedNotCloseTheFingers) {
  Robot robot = RobotAlone(Config());
  GripperGroup& hand = robot.gripper();
  hand.MoveToPose("wave");
  Simulate(robot, 1);
  EXPECT_NEAR(hand.opening(), 0, 1e-9);
  hand.SetOpening(0.5);
  EXPECT_NEAR(hand.opening(), 0.5, 1e-9);
  hand.SetClosingPose("");
  EXPECT_EQ(hand.closing_pose(), "closed");
}

TEST_F(HandPose, TheConfiguredClosingPoseIsThatOfAnOpeningOfZero) {
  RobotConfig config = Config();
  config.move_groups.at("hand").closing_pose = "pinch";
  Robot robot = RobotAlone(config);
  robot.gripper().Close();
  EXPECT_THAT(robot.gripper().ctrl(), Pointwise(DoubleNear(1e-12), kPinch));
}

TEST_F(HandPose, SurvivesARebuildOfTheScene) {
  Robot robot = RobotAlone(Config());
  GripperGroup& hand = robot.gripper();
  hand.MoveToPose("pinch");
  Scene scene = robot.scene();
  scene.AddObject(BoxObject("box", {0, 0.5, 0.1}));
  robot.Update();
  EXPECT_THAT(hand.ctrl(), Pointwise(DoubleNear(1e-12), kPinch));
  EXPECT_EQ(hand.closing_pose(), "pinch");
}

TEST_F(HandPose, ErrorsNameThePoseAndTheAlternatives) {
  Robot robot = RobotAlone(Config());
  GripperGroup& hand = robot.gripper();
  ExpectThrow<NotFoundError>([&] { hand.MoveToPose("pinhc"); }, "Did you mean 'pinch'?");
  ExpectThrow<NotFoundError>([&] { hand.SetClosingPose("fist"); }, "no pose 'fist'");
  ExpectThrow<ArgumentError>([&] { hand.SetClosingPose("open"); },
                             "cannot close towards its pose 'open'");
  EXPECT_EQ(hand.closing_pose(), "closed");
  Robot plain = RobotAlone(Rc7());
  ExpectThrow<NotFoundError>([&] { plain.gripper().MoveToPose("pinch"); },
                             "the gripper has no named poses");
}

TEST_F(HandPose, RejectsPosesThatItsActuatorsCannotHold) {
  const auto refuses = [&](const std::string& pose, Map<double> values, const std::string& text) {
    RobotConfig config = Config();
    config.move_groups.at("hand").poses[pose] = std::move(values);
    ExpectThrow<ArgumentError>([&] { RobotAlone(config); }, text);
  };
  refuses("closed", {{"thumb_1", 1.4}},
          "the control 1.4 is outside the range -1 ... 1 of actuator 'thumb_1'");
  refuses("closed", {{"m2", 0.3}}, "give the control of its actuator 'middle_2' in the pose");
  refuses("closed", {{"thumb_1", -0.3}}, "the controls of 'open' and 'closed' are the same");
}

TEST_F(HandPose, ValidationNamesWhatIsMissing) {
  const auto refuses = [&](const auto& change, const std::string& text) {
    RobotConfig config = Config();
    change(config.move_groups.at("hand"));
    ExpectThrow<SpecError>([&] { RobotAlone(config); }, text);
  };
  refuses(
      [](MoveGroupConfig& hand) {
        hand.poses = {{"open", {}}, {"pinch", {}}};
      },
      "has no pose 'closed' (it has open, pinch)");
  refuses([](MoveGroupConfig& hand) { hand.poses = {{"closed", {}}}; }, "has no pose 'open'");
  refuses([](MoveGroupConfig& hand) { hand.closing_pose = "pinsh"; }, "Did you mean 'pinch'?");
  refuses([](MoveGroupConfig& hand) { hand.closing_pose = "open"; }, "is the open pose");
  refuses([](MoveGroupConfig& hand) { hand.ctrl = GripperCtrl{1, 0}; }, "keep one of them");
  refuses(
      [](MoveGroupConfig& hand) {
        hand.poses["closed"] = {{"thumb", 1}};
      },
      "Did you mean 'thumb_1'?");
}

// A pose that waves has no distance of its own, which is no fault; fingers that swing are one.
TEST_F(HandPose, SaysWhyTheFingersOfAPoseWereNotMeasured) {
  RobotConfig config = Config();
  const std::string swings = Exchanged(
      Exchanged(kHand, R"(<joint name="i2")", R"(<joint name="i2" stiffness=".02" damping="0")"),
      R"(<position name="index_2" joint="i2" ctrlrange="-1 1"/>)",
      R"(<motor name="index_2" joint="i2" ctrlrange="-1 1"/>)");
  config.model = folder_.Write("swings", swings);
  auto& poses = config.move_groups["hand"].poses;
  poses = {};
  poses["open"] = {{"thumb_1", -0.3}};
  poses["closed"] = {{"thumb_1", 0.1}};
  poses["twitch"] = {{"thumb_1", 0.1}, {"index_2", 0.004}};
  poses["wave"] = {{"thumb_1", -0.8}};
  Robot robot = RobotAlone(config);
  GripperGroup& hand = robot.gripper();
  EXPECT_THAT(WarningsOf([&] { hand.SetClosingPose("wave"); }), IsEmpty());
  EXPECT_THAT(WarningsOf([&] { hand.SetClosingPose("twitch"); }),
              ElementsAre(AllOf(HasSubstr("the fingers do not come to rest"),
                                HasSubstr("openings towards pose 'twitch' are the commanded"))));
  EXPECT_EQ(hand.closing_pose(), "twitch");
  EXPECT_THAT(WarningsOf([&] { hand.opening(); }), IsEmpty()) << "measured before";
}

TEST_F(HandPose, ANameOfAnActuatorAndAJointIsTheActuators) {
  RobotConfig config = Config();
  const std::string same =
      Exchanged(Exchanged(kHand, R"(name="middle_1" joint="m1")", R"(name="m1" joint="m1")"),
                R"(name="index_1" joint="i1")", R"(name="i1" joint="i1")");
  config.model = folder_.Write("same", same);
  MoveGroupConfig& hand = config.move_groups["hand"];
  hand.actuators = {"thumb_1", "thumb_2", "i1", "index_2", "m1", "middle_2"};
  hand.poses = {};
  hand.poses["open"] = {{"thumb_1", -0.3}, {"i1", -0.3}};
  hand.poses["closed"] = {{"thumb_1", 0.3}, {"i1", 0.3}, {"m1", 0.4}};
  const std::vector<std::string> warnings = WarningsOf([&] {
    Robot robot = RobotAlone(config);
    robot.gripper().Close();
    EXPECT_EQ(robot.gripper().ctrl()[4], 0.4) << "of the actuator with gear 2: 0.2 rad";
  });
  EXPECT_THAT(warnings,
              Contains(HasSubstr("'m1' in pose 'closed' is the name of an actuator and of "
                                 "a joint. 0.4 is the control of the actuator")));
  EXPECT_THAT(warnings, Not(Contains(HasSubstr("'i1' in pose")))) << "both mean the same";
}

}  // namespace
}  // namespace robocell
