#include "robocell/viewer/viewer_impl.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <chrono>
#include <limits>
#include <stdexcept>
#include <thread>

#include "robocell/base/error.h"
#include "robocell/viewer/testing/users.h"
#include "robocell/viewer/viewer.h"

namespace robocell {
namespace {

TEST_F(Viewers, RunsInRealTime) {
  Viewer viewer = Viewer::Open(scene_, kInMemory);
  viewer.set_realtime_factor(2);
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < 100; ++i) viewer.Step();  // 0.2 s
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  EXPECT_GT(took.count(), 0.08);
  EXPECT_THROW(viewer.set_realtime_factor(-1), ArgumentError);
}

TEST_F(Viewers, FollowsObjectsThatComeAndGo) {
  Viewer viewer = Viewer::Open(scene_, kInMemory);
  viewer.set_realtime_factor(0);
  scene_.AddObject(BoxObject("post", {0.4, 0, 0.02}));
  ASSERT_TRUE(viewer.Show());
  viewer.ShowPanels("Frames", "");
  Click(viewer, "Frames", "post");
  EXPECT_TRUE(viewer.view().ShowsFrame({ViewElement::kBody, "post"}));
  scene_.RemoveObject("post");
  scene_.Reset();
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(viewer.Step());
}

TEST_F(Viewers, EndsWithItsScene) {
  Viewer viewer = Viewer::Open(scene_, kInMemory);
  scene_.Close();
  EXPECT_FALSE(viewer.is_running());
  EXPECT_FALSE(viewer.Step());
  viewer.Close();
}

TEST_F(Viewers, StepsOfOtherThreadsDrawNothing) {
  Viewer viewer = Viewer::Open(scene_, kInMemory);
  std::thread([&] { EXPECT_TRUE(scene_.StepN(20).ok()); }).join();
  EXPECT_TRUE(viewer.Step());
}

TEST_F(Viewers, GoesOnAfterAnExceptionOfAResetHook) {
  Viewer viewer = Viewer::Open(scene_, kInMemory);
  viewer.set_realtime_factor(0);
  bool fails = true;
  scene_.AddResetHook([&](auto&&...) {
    if (std::exchange(fails, false)) throw std::runtime_error("the hook");
  });
  viewer.Post({.type = InputEvent::kKey, .key = mjKEY_BACKSPACE});
  EXPECT_THROW(viewer.Show(), std::runtime_error);
  Key(viewer, ' ');
  EXPECT_TRUE(viewer.paused()) << "it takes input again";
  Key(viewer, ' ');
  EXPECT_TRUE(viewer.Step());
}

// What runs code of programs runs while no OpenGL context is current; this draws and steps.
TEST_F(Viewers, AResetHookMayDrawAndStep) {
  Viewer viewer = Viewer::Open(scene_, kInMemory);
  viewer.set_realtime_factor(0);
  int drawn = 0;
  scene_.AddResetHook([&](auto&&...) {
    int width = 0, height = 0;
    drawn += viewer.Pixels(&width, &height).empty() ? 0 : 1;
    if (!scene_.StepN(3).ok()) drawn = -1;
  });
  Key(viewer, mjKEY_BACKSPACE);
  EXPECT_EQ(drawn, 1);
  EXPECT_TRUE(viewer.Step());
}

TEST_F(Viewers, AStepThatDivergesLeavesNoForceOfTheMouse) {
  Viewer viewer = Viewer::Open(scene_, kInMemory);
  viewer.SetPanelsShown(false);
  viewer.set_realtime_factor(0);
  viewer.view().SetFreeCamera(1, 90, -30, {0.6, 0.2, 0.02});
  viewer.view().SelectBody("cube");
  Drag(viewer, {320, 240}, {320, 400}, mjBUTTON_RIGHT, true);
  scene_.data()->qvel[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(scene_.Step().status, StepResult::kDiverged);
  const mjData* d = scene_.data();
  EXPECT_TRUE(std::all_of(d->xfrc_applied, d->xfrc_applied + 6 * scene_.model()->nbody,
                          [](double x) { return x == 0; }));
}

}  // namespace
}  // namespace robocell
