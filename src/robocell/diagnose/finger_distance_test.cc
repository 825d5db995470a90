// Tests grippers whose finger distance does not match their motion.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/diagnose/testing/lines.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
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

TEST_F(FingerDistance, FingersThatAreNearestAtTheirHingeAreToldToBeNamedByTheirTips) {
  EXPECT_THAT(LinesOfRobot(RobotAlone(Config(0.002, "[{body: hand}, {body: jaw}]"))),
              Contains(HasSubstr("move_groups.gripper.fingers: " + tips_)));
  for (const char* tips : {"[{geom: still}, {geom: moves}]", "[{site: still}, {site: moves}]",
                           "[{geom: moves}, {site: still}]"}) {
    EXPECT_THAT(LinesOfRobot(RobotAlone(Config(0.002, tips))), Not(Contains(HasSubstr("hinge"))))
        << tips;
  }
}

TEST_F(FingerDistance, FingersThatOverlapAtTheirHingeAreToldToo) {
  Robot robot = RobotAlone(Config(-0.004, "[{body: hand}, {body: jaw}]"));
  ExpectThrow<ArgumentError>([&] { robot.gripper().opening(); },
                             "the finger distance stays at 0.0000 m between control 0 and -1.2; "
                             "are `fingers` and `ctrl` right? " +
                                 tips_);
}

}  // namespace
}  // namespace robocell
