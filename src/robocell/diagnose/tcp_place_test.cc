// Tests TCPs that are not where the gripper holds objects.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/files.h"
#include "robocell/diagnose/testing/lines.h"
#include "robocell/robot/testing/robots.h"

namespace robocell {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

// An arm of one joint whose hand has two sliding fingers, 0.1 m long, and the TCP at a given place.
class TcpPlace : public ::testing::Test {
 protected:
  // `arm`: the arm's further fields. `robot`: those of the robot.
  std::vector<std::string> Doubts(const std::string& tcp,
                                  const std::string& arm = ", leaf: {site: tcp}",
                                  const std::string& robot = "") {
    const std::string model = folder_.Write(
        "slides", fmt::format(R"(<compiler angle="radian"/><worldbody><body name="post" pos="0 0 1">
<geom size="0.02" pos="0 0 -0.5"/><body name="hand" pos="0.3 0 0" euler="0.4 0.5 0">
<joint name="roll" axis="0 0 1" range="-2 2" damping="1"/>
<geom type="box" size="0.02 0.06 0.01" mass="1"/><site name="tcp" pos="{}"/>
<body name="left" pos="0 0.02 0.06"><joint name="left" type="slide" axis="0 1 0" range="0 0.03" damping="5"/>
<geom type="box" size="0.01 0.005 0.05" mass="0.05"/></body>
<body name="right" pos="0 -0.02 0.06"><joint name="right" type="slide" axis="0 -1 0" range="0 0.03" damping="5"/>
<geom type="box" size="0.01 0.005 0.05" mass="0.05"/></body></body></body></worldbody>
<contact><exclude body1="hand" body2="left"/><exclude body1="hand" body2="right"/></contact>
<equality><joint joint1="left" joint2="right"/></equality>
<actuator><position name="turn" joint="roll" kp="200" kv="20"/>
<position name="grip" joint="left" kp="400" kv="20" ctrlrange="0 0.03"/></actuator>)",
                              tcp));
    AtomicWrite(file_, "name: slides\nmodel: " + model +
                           "\nmove_groups:\n"
                           "  arm: {kind: arm, joints: [roll], actuators: turn" +
                           arm +
                           "}\n"
                           "  gripper: {kind: gripper, joints: [left, right], actuators: grip}\n"
                           "gravcomp: true\n" +
                           robot);
    return LinesOfRobot(RobotAlone(RobotConfig::Load(file_)));
  }

  ModelFolder folder_;
  const std::string file_ = (folder_.path() / "slides.yaml").string();
};

TEST_F(TcpPlace, AcceptsATcpBetweenTheFingersOrAtTheWrist) {
  for (const char* tcp : {"0 0 0.1", "0 0 0", "0 0 -0.05", "0 0 0.2"})
    EXPECT_THAT(Doubts(tcp), IsEmpty()) << tcp;
}

TEST_F(TcpPlace, WarnsAboutATcpFarFromTheFingers) {
  EXPECT_THAT(
      Doubts("0 0 10"),
      ElementsAre(file_ +
                  ":4:59: move_groups.arm.leaf: the TCP is 9.89 m away from the fingers of "
                  "'gripper', and commands and recordings use the TCP. In the frame of "
                  "'hand' it is at [0, 0, 10] m, and the middle between the fingers at [0, 0, "
                  "0.06]: name a site there (edits: [{add_site: tcp, body: hand, pos: [0, 0, "
                  "0.06]}] adds one)"));
  EXPECT_EQ(Doubts("0.2 0 0.05").size(), 1u);
}

TEST_F(TcpPlace, NamesTheFieldThatPutTheTcpThere) {
  EXPECT_THAT(Doubts("0 0 0", "", "attachment_site: tcp\ntcp_offset: {pos: [0, 0, 10]}\n"),
              ElementsAre(AllOf(HasSubstr(":8:13: tcp_offset: the TCP is 9.89 m away"),
                                EndsWith("correct the offset, which begins at site 'tcp'"))));
  EXPECT_THAT(Doubts("0 0 10", "", "attachment_site: tcp\n"),
              ElementsAre(AllOf(HasSubstr(":7:18: attachment_site: the TCP is 9.89 m away"),
                                HasSubstr("name a site there"))));
}

class RobotsTcp : public ::testing::TestWithParam<RobotCase> {};
INSTANTIATE_TEST_SUITE_P(Robots, RobotsTcp, ::testing::ValuesIn(AllRobots()), CaseName);

TEST_P(RobotsTcp, IsAtItsGripper) {
  REQUIRE_ROBOT(GetParam());
  RobotSpec spec = GetParam().spec();
  spec.name = "r";
  const Scene scene = Scene::Build(SceneWith(spec));
  const Robot robot = GetParam().robot(scene, "r");
  EXPECT_THAT(LinesOfRobot(robot), Not(Contains(HasSubstr("the TCP is"))));
}

}  // namespace
}  // namespace robocell
