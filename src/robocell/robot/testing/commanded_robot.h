// For tests only: a robot that gets invalid commands.
#pragma once

#include <functional>
#include <limits>

#include "robocell/base/error.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
inline const std::string kArm = "robot 'rc7' / group 'arm'";
inline const std::string kGripper = "robot 'rc7' / group 'gripper'";

class CommandedRobot : public ::testing::Test {
 protected:
  std::vector<double> Ctrl() {
    const Scene scene = robot.scene();
    return {scene.data()->ctrl, scene.data()->ctrl + scene.model()->nu};
  }
  // Expects the call to be rejected with the text, and the robot to move as without the call.
  void Refuses(const std::function<void()>& call, const std::string& text) {
    const std::vector<double> ctrl = Ctrl(), state = robot.scene().state();
    ExpectThrow<ArgumentError>(call, text);
    EXPECT_EQ(Ctrl(), ctrl) << text;
    EXPECT_EQ(robot.scene().state(), state) << text;
    robot.Update();
    EXPECT_TRUE(robot.Step().ok()) << text;
  }
  std::vector<double> WithNan(std::vector<double> values, int at) {
    values[at] = kNan;
    return values;
  }

  Robot robot = RobotAlone(Rc7());
  const std::vector<double> home = Rc7().home.at("arm");
};

}  // namespace robocell
