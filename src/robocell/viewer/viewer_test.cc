#include "robocell/viewer/viewer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <memory>

#include "robocell/base/error.h"
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

TEST_F(Viewers, OneViewerStepsAScene) {
  Viewer viewer = Viewer::Open(scene_, kInMemory);
  EXPECT_THROW(Viewer::Open(scene_, kInMemory), Error);
  ViewerOptions pictures = kInMemory;
  pictures.stops_scene = pictures.draws_steps = false;
  EXPECT_THROW(Viewer::Open(scene_, pictures), Error);
  viewer.Close();
  EXPECT_TRUE(Viewer::Open(scene_, kInMemory).is_running());
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

}  // namespace
}  // namespace robocell
