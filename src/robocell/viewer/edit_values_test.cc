#include "robocell/viewer/edit_values.h"

#include <gtest/gtest.h>

#include <string>

#include "robocell/viewer/testing/users.h"

namespace robocell {
namespace {

TEST_F(Viewers, SlidersMoveJointsAndControls) {
  Robot robot = Robot::Of(scene_, "arm");
  Viewer viewer = Viewer::Open(robot, kInMemory);
  viewer.set_paused(true);
  viewer.ShowPanels("", "Joints");
  const std::string joint = robot.joint_names()[1];
  const double before = scene_.joint_pos(joint);
  Click(viewer, "Joints", joint.c_str(), 40);
  const double after = scene_.joint_pos(joint);
  EXPECT_NE(after, before);
  EXPECT_NEAR(robot.jnt_pos_cmd()[1], after, 1e-9) << "the robot holds it";
}

}  // namespace
}  // namespace robocell
