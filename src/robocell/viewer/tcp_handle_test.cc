#include "robocell/viewer/tcp_handle.h"

#include <gtest/gtest.h>

#include <cmath>

#include "robocell/viewer/testing/users.h"

namespace robocell {
namespace {

TEST_F(Viewers, TheHandleOfTheTcpMovesTheRobot) {
  Robot robot = Robot::Of(scene_, "arm");
  Viewer viewer = Viewer::Open(robot, kInMemory);
  viewer.SetPanelsShown(false);
  viewer.set_realtime_factor(0);
  viewer.DragTcp(robot);
  const Eigen::Vector3d before = robot.tcp_in_world().translation();
  viewer.view().SetFreeCamera(1.5, 90, 0, before);
  viewer.Show();
  Drag(viewer, {320, 240}, {340, 260});
  for (int i = 0; i < 500; ++i) {
    robot.Update();
    viewer.Step();
  }
  const Eigen::Vector3d moved = robot.tcp_in_world().translation() - before;
  // The camera looks along +y from 1.5 m: 480 pixels are 2 * 1.5 * tan(22.5 degrees).
  const double metres = 20 * 2 * 1.5 * std::tan(22.5 * 3.14159265 / 180) / 480;
  EXPECT_NEAR(moved.x(), metres, 0.01);
  EXPECT_NEAR(moved.z(), metres, 0.01);
}

}  // namespace
}  // namespace robocell
