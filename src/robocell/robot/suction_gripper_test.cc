// Tests grippers of suction cups and magnets: they stick to what they touch, and let go.
#include "robocell/robot/suction_gripper.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <string>

#include "robocell/base/error.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

// A lift with a cup of 2 cm radius below it, and a plate of 0.1 kg that hangs on nothing.
constexpr const char* kCupOnALift = R"(<worldbody><body name="mast" pos="0 0 1">
  <geom size=".02" contype="0" conaffinity="0"/>
  <body name="cup"><joint name="lift" type="slide" axis="0 0 1" range="-.1 .1"/>
    <geom name="lip" type="cylinder" size=".02 .03" mass=".1" margin=".002" gap=".002"/>
    <site name="tip" pos="0 0 -.03" quat="0 1 0 0"/></body></body></worldbody>
  <actuator><position name="servo" joint="lift" kp="2000" kv="100"/>
    <adhesion name="suck" body="cup" gain="40" {}/></actuator>)";

class Suction : public ::testing::Test {
 protected:
  RobotConfig Config(const std::string& range = "ctrlrange=\"0 1\"") {
    std::string text = kCupOnALift;
    text.replace(text.find("{}"), 2, range);
    return {
        .name = "lifter",
        .model = folder_.Write("lifter", text),
        .move_groups = {
            {"arm",
             {.kind = MoveGroupKind::kArm, .joints = {"lift"}, .leaf = ElementRef{.name = "tip"}}},
            {"cup",
             {.kind = MoveGroupKind::kGripper,
              .actuators = {"suck"},
              .leaf = ElementRef{.name = "tip"}}}}};
  }

  // The plate touches the cup from below.
  Scene SceneWithPlate() {
    SceneSpec spec = SceneWith({.name = "lifter", .config = Config()});
    spec.objects.push_back(BoxObject("plate", {0, 0, 1 - 0.03 - 0.02}));
    return Scene::Build(spec);
  }

  static void Simulate(Robot& robot, double seconds) {
    for (double end = robot.scene().time() + seconds; robot.scene().time() < end;) {
      robot.Update();
      ASSERT_TRUE(robot.Step().ok());
    }
  }

  ModelFolder folder_;
};

TEST_F(Suction, HoldsWhatItSticksToAndLetsGo) {
  Scene scene = SceneWithPlate();
  scene.Reset();
  Robot robot = Robot::Of(scene, "lifter");
  GripperGroup& cup = robot.gripper();
  EXPECT_EQ(robot.gripper_of("arm"), "cup");
  robot.Apply({{"cup", GroupCommand::Opening(0)}});
  Simulate(robot, 0.5);
  const double height = scene.body_pose("plate").translation().z();
  EXPECT_NEAR(height, 0.95, 0.003);
  EXPECT_TRUE(cup.is_grasping("plate"));
  EXPECT_TRUE(cup.is_grasping());
  EXPECT_FALSE(cup.is_open());
  robot.Apply({{"arm", GroupCommand::Joints({0.08})}});
  Simulate(robot, 0.5);
  EXPECT_NEAR(scene.body_pose("plate").translation().z(), height + 0.08, 0.005) << "it is carried";
  robot.Apply({{"cup", GroupCommand::Opening(1)}});
  Simulate(robot, 0.3);
  EXPECT_LT(scene.body_pose("plate").translation().z(), height - 0.1) << "it falls";
  EXPECT_FALSE(cup.is_grasping("plate"));
  EXPECT_FALSE(cup.is_grasping());
  EXPECT_TRUE(cup.is_open());
}

TEST_F(Suction, OpeningsAreSharesOfTheControlRange) {
  Robot robot = RobotAlone(Config());
  GripperGroup& cup = robot.gripper();
  for (const double opening : {1.0, 0.25, 0.0}) {
    cup.SetOpening(opening);
    EXPECT_NEAR(cup.ctrl()[0], 1 - opening, 1e-12);
    EXPECT_NEAR(cup.opening(), opening, 1e-12);
    EXPECT_NEAR(cup.ctrl_for_opening(opening), 1 - opening, 1e-12);
  }
  EXPECT_EQ(cup.inter_finger_dist(), 0);
  ExpectThrow<ArgumentError>([&] { cup.SetOpening(std::nan("")); }, "opening cannot be nan");
}

TEST_F(Suction, TakesTheConfiguredControls) {
  RobotConfig config = Config();
  config.move_groups.at("cup").ctrl = GripperCtrl{.open = 0.2, .closed = 0.6};
  Robot robot = RobotAlone(config);
  robot.gripper().Close();
  EXPECT_EQ(robot.gripper().ctrl()[0], 0.6);
  robot.gripper().Open();
  EXPECT_EQ(robot.gripper().ctrl()[0], 0.2);
}

TEST_F(Suction, HoldsAfterARebuildOfTheScene) {
  Scene scene = SceneWithPlate();
  scene.Reset();
  Robot robot = Robot::Of(scene, "lifter");
  robot.Apply({{"cup", GroupCommand::Opening(0)}});
  Simulate(robot, 0.2);
  scene.AddObject(BoxObject("other", {2, 0, 0}));
  Simulate(robot, 0.2);
  EXPECT_TRUE(robot.gripper().is_grasping("plate"));
  EXPECT_FALSE(robot.gripper().is_grasping("other"));
}

}  // namespace
}  // namespace robocell
