#include "robocell/viewer/viewer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/scene/step_gate.h"
#include "robocell/viewer/testing/users.h"

namespace robocell {
namespace {

TEST_F(Viewers, StepsTheSceneUntilTheUserClosesTheWindow) {
  Viewer viewer = Viewer::Open(scene_, kInMemory);
  viewer.set_realtime_factor(0);
  const double start = scene_.time();
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(viewer.Step());
  EXPECT_NEAR(scene_.time() - start, 10 * scene_.timestep(), 1e-9);
  viewer.Post({.type = InputEvent::kClose});
  viewer.Show();
  EXPECT_FALSE(viewer.is_running());
  EXPECT_FALSE(viewer.Step());
  Robot robot = Robot::Of(scene_, "arm");
  const double now = scene_.time();
  EXPECT_EQ(scene_.Step().status, StepResult::kStopped);
  EXPECT_FALSE(robot.Step().ok());
  EXPECT_THAT(robot.Step().message, ::testing::HasSubstr("closed the window 'test'"));
  EXPECT_EQ(scene_.time(), now);
  viewer.Close();
  EXPECT_TRUE(robot.Step().ok()) << "the scene goes on after close()";
  EXPECT_GT(scene_.time(), now);
}

TEST_F(Viewers, EndsTheLoopsOfRobotsAndGoesOnWithoutAViewer) {
  {
    Viewer viewer = Viewer::Open(Robot::Of(scene_, "arm"), kInMemory);
    viewer.set_realtime_factor(0);
    viewer.Post({.type = InputEvent::kClose});
    Robot robot = Robot::Of(scene_, "arm");
    int steps = 0;
    while (robot.Step().ok() && steps < 100000) ++steps;
    EXPECT_LT(steps, 100000);
  }
  EXPECT_TRUE(scene_.Step().ok());
}

TEST_F(Viewers, EnvironmentsGoOnWhenTheirWindowIsClosed) {
  ViewerOptions options = kInMemory;
  options.stops_scene = false;
  Viewer viewer = Viewer::Open(scene_, options);
  viewer.Post({.type = InputEvent::kClose});
  viewer.Show();
  EXPECT_TRUE(scene_.Step().ok());
}

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

TEST_F(Viewers, RunsInRealTime) {
  Viewer viewer = Viewer::Open(scene_, kInMemory);
  viewer.set_realtime_factor(2);
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < 100; ++i) viewer.Step();  // 0.2 s
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  EXPECT_GT(took.count(), 0.08);
  EXPECT_THROW(viewer.set_realtime_factor(-1), ArgumentError);
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

TEST_F(Viewers, OneViewerStepsAScene) {
  Viewer viewer = Viewer::Open(scene_, kInMemory);
  EXPECT_THROW(Viewer::Open(scene_, kInMemory), Error);
  ViewerOptions pictures = kInMemory;
  pictures.stops_scene = pictures.draws_steps = false;
  EXPECT_THROW(Viewer::Open(scene_, pictures), Error);
  viewer.Close();
  EXPECT_TRUE(Viewer::Open(scene_, kInMemory).is_running());
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

TEST_F(Viewers, ANewViewerReplacesOneThatTheUserClosed) {
  Viewer first = Viewer::Open(scene_, kInMemory);
  first.Post({.type = InputEvent::kClose});
  first.Show();
  EXPECT_EQ(scene_.Step().status, StepResult::kStopped);
  {
    Viewer second = Viewer::Open(scene_, kInMemory);
    EXPECT_TRUE(scene_.Step().ok());
    second.set_paused(true);
    EXPECT_EQ(scene_.StepN(5).steps, 0);
    EXPECT_THROW(Viewer::Open(scene_, kInMemory), Error) << "the first one hides it not";
  }
  EXPECT_TRUE(scene_.Step().ok());
  EXPECT_FALSE(first.Step());
}

TEST_F(Viewers, RefusesRobotsOfAnotherScene) {
  const Scene other = Scene::Build(Spec());
  const Robot stranger = Robot::Of(other, "arm");
  EXPECT_THROW(Viewer::Open(scene_, {stranger}, kInMemory), ArgumentError);
  Viewer viewer = Viewer::Open(scene_, kInMemory);
  EXPECT_THROW(viewer.DragTcp(stranger), ArgumentError);
  EXPECT_EQ(viewer.scenes_held(), 1 + viewer.view().robots().size());
}

TEST_F(Viewers, WhereStepsGoOnThereIsNoPauseAndNoReset) {
  ViewerOptions options = kInMemory;
  options.stops_scene = options.draws_steps = false;
  Viewer viewer = Viewer::Open(scene_, options);
  EXPECT_TRUE(scene_.StepN(5).ok());
  const double now = scene_.time();
  for (const int key : {static_cast<int>(' '), static_cast<int>(mjKEY_BACKSPACE),
                        static_cast<int>(mjKEY_RIGHT), static_cast<int>(',')})
    Key(viewer, key);
  EXPECT_FALSE(viewer.paused());
  EXPECT_EQ(viewer.realtime_factor(), 1);
  EXPECT_EQ(scene_.time(), now);
  EXPECT_THROW(viewer.PlaceOf("Run", "Reset"), NotFoundError);
  EXPECT_THROW(viewer.PlaceOf("Run", "One step"), NotFoundError);
  EXPECT_THROW(viewer.PlaceOf("RTF", "Unlimited"), NotFoundError);
  EXPECT_NO_THROW(viewer.PlaceOf("Run", "Screenshot"));
  EXPECT_THROW(viewer.set_paused(true), Error);
}

TEST_F(Viewers, EpisodesAreNotStopped) {
  const auto episodes = std::make_shared<SceneObserver>();
  scene_.AddObserver(episodes, internal::kEpisodesKey);
  Viewer viewer = Viewer::Open(scene_, kInMemory);
  Key(viewer, ' ');
  EXPECT_FALSE(viewer.paused());
  viewer.Post({.type = InputEvent::kClose});
  viewer.Show();
  EXPECT_TRUE(scene_.Step().ok());
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
