// Tests the warning about a floating base that nothing holds up.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "robocell/base/files.h"
#include "robocell/diagnose/testing/lines.h"
#include "robocell/robot/testing/robots.h"

namespace robocell {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

class FloatingBases : public ::testing::Test {
 protected:
  // An arm of one joint on a body with or without a free joint.
  std::vector<std::string> Doubts(const std::string& joint) {
    const std::string model =
        folder_.Write("box", R"(<worldbody><body name="trunk" pos="0 0 1">)" + joint + R"(
      <geom type="box" size="0.1 0.1 0.1" mass="5"/><body name="arm" pos="0 0 0.1">
      <joint name="hip" axis="0 1 0" range="-114 114"/><geom type="capsule" size="0.02" fromto="0 0 0 0 0 0.2"
      mass="0.1" contype="0" conaffinity="0"/><site name="tip" pos="0 0 0.2"/></body></body></worldbody>
      <actuator><position name="drive" joint="hip" kp="50" kv="5"/></actuator>)");
    const std::string file = (folder_.path() / "box.yaml").string();
    AtomicWrite(file, "name: box\nmodel: " + model +
                          "\nmove_groups:\n  arm: {kind: arm, joints: [hip], leaf: {site: tip}}\n");
    return LinesOfRobot(RobotAlone(RobotConfig::Load(file)));
  }

  ModelFolder folder_;
};

TEST_F(FloatingBases, AreReportedIfTheyFall) {
  EXPECT_THAT(Doubts("<freejoint name='root'/>"),
              Contains(HasSubstr("base: its base floats on the free joint of 'trunk' and falls")));
  EXPECT_THAT(Doubts(""), Not(Contains(HasSubstr("floats"))));
}

}  // namespace
}  // namespace robocell
