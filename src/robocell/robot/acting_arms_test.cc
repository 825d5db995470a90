// Tests a robot that is seen from one of its arms.
#include "robocell/robot/acting_arms.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/robot/testing/torso.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// A post with an arm of two hinges to each side; the arms have different lengths.
RobotConfig Pair(ModelFolder& folder) {
  const auto side = [](const char* name, double y, double length) {
    return fmt::format(
        R"(<body name="{0}a" pos="0 {1} .5"><joint name="{0}1" axis="0 0 1" range="-2 2" damping="2"/>
<geom type="capsule" size=".02" fromto="0 0 0 {2} 0 0" mass="1"/>
<body name="{0}b" pos="{2} 0 0"><joint name="{0}2" axis="0 0 1" range="-2 2" damping="2"/>
<geom type="capsule" size=".02" fromto="0 0 0 .1 0 0" mass=".5"/><site name="{0}" pos=".1 0 0"/></body></body>)",
        name, y, length);
  };
  std::string servos;
  for (const char* joint : {"l1", "l2", "r1", "r2"})
    servos += fmt::format(R"(<position name="{0}" joint="{0}" kp="200" kv="20"/>)", joint);
  const std::string model = folder.Write(
      "pair",
      fmt::format(R"(<compiler angle="radian"/><worldbody><body name="post">{}{}</body></worldbody>
<actuator>{}</actuator>)",
                  side("l", 0.3, 0.2), side("r", -0.3, 0.3), servos));
  return ParseYaml<RobotConfig>("name: pair\nmodel: " + model +
                                    "\nroot_body: post\nmove_groups:\n"
                                    "  left: {kind: arm, joints: [l1, l2], leaf: {site: l}}\n"
                                    "  right: {kind: arm, joints: [r1, r2], leaf: {site: r}}\n"
                                    "gravcomp: true\n",
                                "pair.yaml");
}

TEST(ActingArms, AreNamedByRobotAndArm) {
  ModelFolder folder;
  const Robot robot = RobotAlone(Pair(folder));
  EXPECT_THAT(internal::ActingArms(robot.config(), "pair"), ElementsAre("pair/left", "pair/right"));
  EXPECT_THAT(internal::ActingArms(robot.scene()), ElementsAre("pair/left", "pair/right"));
  for (const std::string& name : internal::ActingArms(robot.scene())) {
    const Robot seen = Robot::Of(robot.scene(), name);
    EXPECT_EQ(internal::ActingName(seen), name);
    EXPECT_EQ(seen.name(), "pair");
  }
  EXPECT_EQ(internal::ActingName(robot), "pair/left");
}

// The TCP, the chain and the joints are those of the arm, by the engine's own poses.
TEST(ActingArms, HaveTheirOwnChainAndTcp) {
  ModelFolder folder;
  Scene scene = RobotAlone(Pair(folder)).scene();
  Robot right = Robot::Of(scene, "pair/right");
  EXPECT_EQ(right.arm().name(), "right");
  EXPECT_THAT(right.joint_names(), ElementsAre(HasSubstr("r1"), HasSubstr("r2")));
  right.SetJointPos(std::vector<double>{0.4, -0.3});
  const Pose by_engine = right.group("right").leaf_frame_to_world();
  EXPECT_TRUE(right.tcp_in_world().is_close(by_engine, 1e-12, 1e-12));
  const IkResult ik = right.Ik(right.FkFrame());
  ASSERT_TRUE(ik.success);
  EXPECT_NEAR(ik.q[0], 0.4, 1e-4);
  EXPECT_FALSE(Robot::Of(scene, "pair").tcp_in_world().is_close(by_engine, 0.1, 10));
}

// What is commanded from one view is what the robot itself drives: they share the controllers.
TEST(ActingArms, ShareTheRobotsControllers) {
  ModelFolder folder;
  Robot robot = RobotAlone(Pair(folder));
  Robot right = Robot::Of(robot.scene(), "pair/right");
  EXPECT_EQ(&right.controller("right"), &robot.controller("right"));
  EXPECT_EQ(&right.controller("left"), &robot.controller("left"));
  right.Apply({{"right", GroupCommand::Joints({0.3, 0.2})}});
  for (int i = 0; i < 1500; ++i) {
    robot.Update();
    ASSERT_TRUE(robot.Step().ok());
  }
  EXPECT_NEAR(right.arm().joint_pos()[0], 0.3, 0.01);
  EXPECT_NEAR(robot.group("right").joint_pos()[1], 0.2, 0.01);
  EXPECT_NEAR(robot.arm().joint_pos()[0], 0, 0.01);
}

TEST(ActingArms, ShareTheCommandsOfTheGrippers) {
  ModelFolder folder;
  Robot robot = RobotAlone(Torso(folder, {"l", "r"}));
  Robot right = Robot::Of(robot.scene(), "torso/r_arm");
  robot.Apply({{"r_hand", GroupCommand::Opening(0.3)}});
  EXPECT_NEAR(right.controller("r_hand").target()[0], 0.3, 1e-9);
  right.Apply({{"r_hand", GroupCommand::Opening(0.8)}});
  robot.Update();
  EXPECT_NEAR(robot.controller("r_hand").target()[0], 0.8, 1e-9);
  EXPECT_EQ(&right.controller("l_hand"), &robot.controller("l_hand"));
}

TEST(ActingArms, OfAnUnknownNameListTheArms) {
  ModelFolder folder;
  const Scene scene = RobotAlone(Pair(folder)).scene();
  ExpectThrow<NotFoundError>([&] { Robot::Of(scene, "pair/rihgt"); },
                             "no arm 'rihgt'. Its arms: left, right. Did you mean 'right'?");
}

}  // namespace
}  // namespace robocell
