// Tests the warning about a floating base that nothing holds up.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "robocell/base/files.h"
#include "robocell/diagnose/testing/lines.h"
#include "robocell/diagnose/trials.h"
#include "robocell/robot/testing/robots.h"

namespace robocell {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

class FloatingBases : public ::testing::Test {
 protected:
  // An arm of one joint on a body at a height, with or without a free joint.
  Robot Box(const std::string& joint, double height = 1) {
    const std::string model =
        folder_.Write("box", fmt::format(R"(<worldbody><body name="trunk" pos="0 0 {}">{}
      <geom type="box" size="0.1 0.1 0.1" mass="5"/><body name="arm" pos="0 0 0.1">
      <joint name="hip" axis="0 1 0" range="-114 114"/><geom type="capsule" size="0.02" fromto="0 0 0 0 0 0.2"
      mass="0.1" contype="0" conaffinity="0"/><site name="tip" pos="0 0 0.2"/></body></body></worldbody>
      <actuator><position name="drive" joint="hip" kp="50" kv="5"/></actuator>)",
                                         height, joint));
    const std::string file = (folder_.path() / "box.yaml").string();
    AtomicWrite(file, "name: box\nmodel: " + model +
                          "\nmove_groups:\n  arm: {kind: arm, joints: [hip], leaf: {site: tip}}\n");
    return RobotAlone(RobotConfig::Load(file));
  }

  // The findings of this check alone.
  static std::vector<Finding> Try(Robot robot) {
    internal::Findings findings("robot 'box'",
                                [](const std::string&, std::string_view) { return ""; });
    internal::TryFloatingBase(robot, {}, findings);
    return findings.list();
  }

  ModelFolder folder_;
};

// Returns how far the engine lets the trunk fall from home in a second.
double Fall(const Robot& robot) {
  Scene scene = robot.scene();
  scene.Reset();
  const auto height = [&] { return scene.body_pose("trunk").translation().z(); };
  const double before = height();
  EXPECT_TRUE(scene.StepN(static_cast<int>(std::lround(1 / scene.timestep()))).ok());
  return before - height();
}

TEST_F(FloatingBases, AreReportedIfTheyFall) {
  const std::vector<std::string> lines = LinesOfRobot(Box("<freejoint name='root'/>"));
  EXPECT_THAT(lines,
              Contains(HasSubstr("base: its base floats on the free joint of 'trunk' and falls")));
  EXPECT_THAT(LinesOfRobot(Box("")), Not(Contains(HasSubstr("floats"))));
}

// The engine is the oracle: what falls is reported with its way, what stands is not.
TEST_F(FloatingBases, AreReportedWithTheFallThatTheEngineMakes) {
  for (const double height : {0.1, 0.12, 0.2, 0.5, 1.0}) {
    const Robot robot = Box("<freejoint name='root'/>", height);
    const double fall = Fall(robot);
    robot.scene().Reset();
    const std::vector<double> state = robot.scene().state();
    const std::vector<Finding> findings = Try(robot);
    EXPECT_EQ(robot.scene().state(), state) << "the robot is tried in a copy";
    if (fall <= 0.05) {
      EXPECT_THAT(findings, ::testing::IsEmpty()) << height << " m high, falls " << fall;
      continue;
    }
    ASSERT_EQ(findings.size(), 1u) << height << " m high, falls " << fall;
    EXPECT_EQ(findings[0].severity, Severity::kWarning);
    EXPECT_THAT(findings[0].text, HasSubstr(fmt::format("falls {:.2f} m", fall)));
  }
}

}  // namespace
}  // namespace robocell
