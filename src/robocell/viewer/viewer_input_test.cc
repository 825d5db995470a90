// What keys and the mouse do: viewer_input.cc.
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cstdlib>
#include <variant>
#include <vector>

#include "robocell/viewer/testing/users.h"
#include "robocell/viewer/viewer.h"

namespace robocell {
namespace {

TEST_F(Viewers, SpacePausesAndRightMakesOneStep) {
  Viewer viewer = Viewer::Open(scene_, kInMemory);
  viewer.set_realtime_factor(0);
  Key(viewer, ' ');
  EXPECT_TRUE(viewer.paused());
  const double now = scene_.time();
  EXPECT_TRUE(viewer.Step());
  const StepResult held = scene_.StepN(5);
  EXPECT_TRUE(held.ok());
  EXPECT_EQ(held.steps, 0);
  EXPECT_EQ(scene_.time(), now);
  viewer.Post({.type = InputEvent::kKey, .key = mjKEY_RIGHT});
  viewer.Step();
  viewer.Step();
  viewer.Step();
  EXPECT_NEAR(scene_.time() - now, scene_.timestep(), 1e-9);
  Key(viewer, ' ');
  EXPECT_TRUE(viewer.Step());
  EXPECT_NEAR(scene_.time() - now, 2 * scene_.timestep(), 1e-9);
}

TEST_F(Viewers, TheKeysOfTheSpeedHalveAndDoubleIt) {
  Viewer viewer = Viewer::Open(scene_, kInMemory);
  Key(viewer, ',');
  EXPECT_EQ(viewer.realtime_factor(), 0.5);
  Key(viewer, '.');
  Key(viewer, '.');
  EXPECT_EQ(viewer.realtime_factor(), 2);
}

TEST_F(Viewers, KeysChangeTheCameraAndResetTheScene) {
  Viewer viewer = Viewer::Open(scene_, kInMemory);
  viewer.set_realtime_factor(0);
  Key(viewer, '[');
  EXPECT_EQ(viewer.view().camera(), viewer.view().camera_names().back());
  Key(viewer, mjKEY_ESCAPE);
  EXPECT_EQ(viewer.view().camera(), "Free");
  for (int i = 0; i < 5; ++i) viewer.Step();
  Key(viewer, mjKEY_BACKSPACE);
  EXPECT_EQ(scene_.time(), 0);
}

TEST_F(Viewers, TheMouseTurnsTheCamera) {
  Viewer viewer = Viewer::Open(scene_, kInMemory);
  viewer.SetPanelsShown(false);
  const auto before = std::get<OrbitCamera>(viewer.view().view());
  Drag(viewer, {320, 240}, {400, 240});
  const auto after = std::get<OrbitCamera>(viewer.view().view());
  EXPECT_GT(std::abs(after.azimuth - before.azimuth), 5);
  EXPECT_EQ(after.lookat, before.lookat);
}

TEST_F(Viewers, TheMousePullsASelectedBody) {
  Viewer viewer = Viewer::Open(scene_, kInMemory);
  viewer.SetPanelsShown(false);
  viewer.set_realtime_factor(0);
  viewer.view().SetFreeCamera(1, 90, -30, {0.6, 0.2, 0.02});
  viewer.view().SelectBody("cube");
  Drag(viewer, {320, 240}, {320, 400}, mjBUTTON_RIGHT, true);
  for (int i = 0; i < 150; ++i) viewer.Step();
  EXPECT_GT(scene_.body_pose("cube").translation().z(), 0.05);
  Release(viewer, {320, 400}, mjBUTTON_RIGHT);
  for (int i = 0; i < 500; ++i) viewer.Step();
  EXPECT_LT(scene_.body_pose("cube").translation().z(), 0.04) << "it falls again";
}

TEST_F(Viewers, KeepsTheNewestKeys) {
  Viewer viewer = Viewer::Open(scene_, kInMemory);
  for (int i = 0; i < 100; ++i) viewer.Post({.type = InputEvent::kKey, .key = 1000 + i});
  viewer.Show();
  const std::vector<int> keys = viewer.TakeKeys();
  ASSERT_EQ(keys.size(), 64u);
  EXPECT_EQ(keys.back(), 1099);
  EXPECT_TRUE(viewer.TakeKeys().empty());
}

}  // namespace
}  // namespace robocell
