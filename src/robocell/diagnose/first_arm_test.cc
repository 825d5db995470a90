// Tests what `check` notes of robots with several arms.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/files.h"
#include "robocell/diagnose/testing/lines.h"
#include "robocell/robot/testing/robots.h"

namespace robocell {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

// Two arms on one post; the gripper is on that of the given side.
class FirstArm : public ::testing::Test {
 protected:
  Robot Make(const std::string& first, const std::string& second) {
    const auto side = [&](const char* name, double y) {
      return fmt::format(
          R"(<body name="{0}" pos="0 {1} 0"><joint name="{0}" axis="0 0 1" damping="1"/>
<geom type="box" size=".02 .01 .01" mass="1"/><site name="{0}"/>{2}</body>)",
          name, y, std::string(name) == "right" ? kFingers : "");
    };
    const std::string model = folder_.Write(
        "two", fmt::format(R"(<compiler angle="radian"/><worldbody><body name="post" pos="0 0 1">
<geom size="0.02" pos="0 0 -0.5"/>{}{}</body></worldbody><equality><joint joint1="a" joint2="b"/></equality>
<actuator><position name="left" joint="left" kp="200" kv="20"/>
<position name="right" joint="right" kp="200" kv="20"/>
<position name="grip" joint="a" kp="400" kv="20" ctrlrange="0 0.03"/></actuator>)",
                           side("left", 0.3), side("right", -0.3)));
    const auto arm = [](const std::string& name) {
      return fmt::format("  {0}: {{kind: arm, joints: [{0}], leaf: {{site: {0}}}}}\n", name);
    };
    AtomicWrite(file_, fmt::format("name: two\nmodel: {}\ngravcomp: true\nmove_groups:\n{}{}"
                                   "  grip: {{kind: gripper, joints: [a, b], actuators: grip}}\n",
                                   model, arm(first), arm(second)));
    return RobotAlone(RobotConfig::Load(file_));
  }

  static constexpr const char* kFingers =
      R"(<body name="a" pos="0 0.02 0.06"><joint name="a" type="slide" axis="0 1 0" range="0 0.03" damping="5"/>
<geom type="box" size="0.01 0.005 0.03" mass="0.05"/></body>
<body name="b" pos="0 -0.02 0.06"><joint name="b" type="slide" axis="0 -1 0" range="0 0.03" damping="5"/>
<geom type="box" size="0.01 0.005 0.03" mass="0.05"/></body>)";
  ModelFolder folder_;
  const std::string file_ = (folder_.path() / "two.yaml").string();
};

TEST_F(FirstArm, AndTheOthersAreNotedWithTheirGrippers) {
  for (const bool right_first : {true, false}) {
    const std::vector<Finding> found =
        CheckRobot(right_first ? Make("right", "left") : Make("left", "right"));
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].severity, Severity::kNote);
    EXPECT_THAT(found[0].text, HasSubstr(right_first ? "right with grip, left without a gripper"
                                                     : "left without a gripper, right with grip"));
  }
}

TEST_F(FirstArm, IsNotReportedBeforeARun) {
  EXPECT_THAT(LinesOfRobot(Make("left", "right"), {.for_run = true}),
              Not(Contains(HasSubstr("of kind arm"))));
}

}  // namespace
}  // namespace robocell
