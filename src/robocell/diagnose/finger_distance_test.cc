// Tests grippers whose finger distance does not match their motion.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/log.h"
#include "robocell/diagnose/testing/lines.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

// A jaw on a hinge in the hand, its knuckle `gap` metres from the palm.
class FingerDistance : public ::testing::Test {
 protected:
  RobotConfig Config(double gap, const char* fingers) {
    const std::string model =
        folder_.Write("jaw", fmt::format(R"(<compiler angle="radian"/><worldbody><body name="post">
<geom size="0.02" pos="0 0 -0.5"/><body name="hand"><joint name="roll" axis="0 0 1" range="-2 2"/>
<geom type="box" size="0.02 0.01 0.01" mass="1"/><site name="tip" pos="0 0 0.1"/>
<geom name="still" type="box" size="0.004 0.01 0.03" pos="0.02 0 0.06"/>
<site name="still" pos="0.02 0 0.09"/>
<body name="jaw" pos="-0.01 0 {}"><joint name="jaw" axis="0 1 0" range="-1.2 0" damping="0.05"/>
<geom type="box" size="0.008 0.01 0.008" mass="0.02"/><site name="moves" pos="0 0 0.07"/>
<geom name="moves" type="box" size="0.004 0.01 0.03" pos="0 0 0.04" mass="0.02"/></body>
</body></body></worldbody><actuator><position name="drive" joint="roll" kp="200" kv="20"/>
<position name="grip" joint="jaw" kp="20" kv="1" ctrlrange="-1.2 0"/></actuator>)",
                                         0.018 + gap));
    AtomicWrite(file_, fmt::format("name: jaw\nmodel: {}\nmove_groups:\n"
                                   "  arm: {{kind: arm, joints: [roll], leaf: {{site: tip}}}}\n"
                                   "  gripper: {{kind: gripper, joints: [jaw], actuators: grip, "
                                   "fingers: {}}}\n",
                                   model, fingers));
    return RobotConfig::Load(file_);
  }
  ModelFolder folder_;
  const std::string file_ = (folder_.path() / "jaw.yaml").string();
  const std::string tips_ =
      "'jaw' turns about a hinge in 'hand', and the two are nearest at the hinge, however far "
      "their tips are apart: name the tips of both as `fingers`, geoms or sites (edits: "
      "[{add_site: tip, body: jaw, pos: [...]}] adds one)";
};

TEST_F(FingerDistance, SuggestsTipsIfFingersAreClosestAtTheHinge) {
  EXPECT_THAT(LinesOfRobot(RobotAlone(Config(0.002, "[{body: hand}, {body: jaw}]"))),
              Contains(HasSubstr("move_groups.gripper.fingers: " + tips_)));
  for (const char* tips : {"[{geom: still}, {geom: moves}]", "[{site: still}, {site: moves}]",
                           "[{geom: moves}, {site: still}]"}) {
    EXPECT_THAT(LinesOfRobot(RobotAlone(Config(0.002, tips))), Not(Contains(HasSubstr("hinge"))))
        << tips;
  }
}

TEST_F(FingerDistance, SuggestsTipsIfFingersOverlapAtTheHinge) {
  Robot robot = RobotAlone(Config(-0.004, "[{body: hand}, {body: jaw}]"));
  ExpectThrow<ArgumentError>([&] { robot.gripper().opening(); },
                             "the finger distance stays at 0.0000 m between control 0 and -1.2; "
                             "are `fingers` and `ctrl` right? " +
                                 tips_);
}

// Two fingers of 0.1 m on hinges 0.06 m apart.
class HingedFingers : public ::testing::Test {
 protected:
  RobotConfig Config(const std::string& servo, const std::string& rest,
                     const std::string& geom = "") {
    const std::string finger = R"(<body name="{0}" pos="{1} 0 0.02"><joint name="{0}" axis="0 {2} 0"
range="-0.8 0.8" damping="0.2" armature="0.005"/><geom name="{0}" type="capsule" size="0.008"
fromto="0 0 0 0 0 0.1" mass="0.05" {3}/></body>)";
    const std::string model = folder_.Write(
        "hinged",
        fmt::format(R"(<compiler angle="radian"/><worldbody><body name="post" pos="0 0 1">
<geom size="0.02" pos="0 0 -0.5"/><body name="hand"><joint name="roll" axis="0 0 1" range="-2 2"/>
<geom type="box" size="0.06 0.01 0.01" mass="1"/><site name="tip" pos="0 0 0.1"/>{}{}
</body></body></worldbody><tendon><fixed name="both"><joint joint="left" coef="1"/>
<joint joint="right" coef="1"/></fixed></tendon><equality><joint joint1="right" joint2="left"/>
</equality><actuator><position name="drive" joint="roll" kp="200" kv="20"/>
<position name="grip" tendon="both" {}/></actuator>)",
                    fmt::format(fmt::runtime(finger), "left", "-0.03", "-1", geom),
                    fmt::format(fmt::runtime(finger), "right", "0.03", "1", geom), servo));
    AtomicWrite(file_, "name: hinged\nmodel: " + model +
                           "\nmove_groups:\n  arm: {kind: arm, joints: [roll], leaf: {site: tip}}\n"
                           "  gripper: {kind: gripper, joints: [left, right], actuators: grip" +
                           rest);
    return RobotConfig::Load(file_);
  }
  ModelFolder folder_;
  const std::string file_ = (folder_.path() / "hinged.yaml").string();
  const std::string gentle_ = R"(kp="1" kv="0.2" ctrlrange="-1 1" forcerange="-0.5 0.5")";
  const std::string strong_ = R"(kp="20" kv="1" ctrlrange="-1.6 1.6")";
};

// Returns what follows `start` in the line, up to the bracket that closes it.
std::string Advice(const std::string& line, const std::string& start) {
  const size_t from = line.find(start);
  if (from == std::string::npos) return "";
  size_t to = line.find('[', from);
  for (int depth = 0; to < line.size(); ++to) {
    depth += line[to] == '[' ? 1 : line[to] == ']' ? -1 : 0;
    if (depth == 0) break;
  }
  return line.substr(from, to + 1 - from);
}

TEST_F(HingedFingers, SuggestWhereToMeasureTheDistance) {
  std::vector<std::string> warnings;
  const ScopedLogSink sink([&](LogLevel, std::string_view text) { warnings.emplace_back(text); });
  const RobotConfig config = Config(gentle_, "}\n");
  const std::vector<std::string> lines = LinesOfRobot(RobotAlone(config));
  const auto flat_part = HasSubstr("the distance of 'left' and 'right' stays at 0.044 m for ");
  ASSERT_THAT(lines, ElementsAre(AllOf(HasSubstr("move_groups.gripper.fingers: "), flat_part)));
  RobotAlone(config).gripper().opening();
  EXPECT_THAT(warnings, ElementsAre(flat_part, flat_part)) << "once for each of the two models";
  warnings.clear();
  const std::string fingers = Advice(lines[0], "fingers: [{"), edits = Advice(lines[0], "edits: [");
  EXPECT_THAT(fingers, HasSubstr("[{site: left_tip}, {site: right_tip}]"));
  Robot robot = RobotAlone(Config(gentle_, ", " + fingers + "}\n" + edits + "\n"));
  EXPECT_THAT(LinesOfRobot(robot), IsEmpty()) << fingers << edits;
  double last = 1.1;
  for (const double opening : {1.0, 0.8, 0.6, 0.4, 0.2}) {
    robot.gripper().SetOpening(opening);
    ASSERT_TRUE(robot.scene().StepN(1000).ok());
    EXPECT_LT(robot.gripper().opening(), last - 0.05) << opening;
    last = robot.gripper().opening();
  }
  EXPECT_THAT(warnings, IsEmpty());
}

TEST_F(HingedFingers, SuggestEditsAgainstPenetration) {
  const std::vector<std::string> lines = LinesOfRobot(RobotAlone(Config(strong_, "}\n")));
  const auto press = HasSubstr("press 0.01");
  ASSERT_THAT(lines, Contains(press));
  std::string edits;
  for (const std::string& line : lines) {
    if (line.find("into each other") != std::string::npos) edits = Advice(line, "edits: [");
  }
  EXPECT_THAT(edits, HasSubstr("{actuator: 'grip', forcerange: [-"));
  const auto presses = Contains(HasSubstr("into each other"));
  EXPECT_THAT(LinesOfRobot(RobotAlone(Config(strong_, "}\n" + edits + "\n"))), Not(presses));
  EXPECT_THAT(LinesOfRobot(RobotAlone(Config(strong_, "}\n", R"(solref="0.004 1")"))),
              Not(presses));
}

}  // namespace
}  // namespace robocell
