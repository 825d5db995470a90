#include "robocell/viewer/viewer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cstdlib>
#include <string>
#include <thread>

#include "robocell/assets/resolve.h"
#include "robocell/base/error.h"
#include "robocell/media/video_info.h"
#include "robocell/render/gl_context.h"
#include "robocell/scene/step_gate.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/spec/robot_config.h"
#include "robocell/testing/scoped_env.h"
#include "robocell/testing/skip.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

constexpr ViewerOptions kInMemory{.width = 640, .height = 480, .on_screen = false};

// Acts as a user: in memory, without a display.
class Viewers : public testing::Test {
 protected:
  Viewers() : scene_(Scene::Build(Spec())) {}
  void SetUp() override {
    try {
      DescribeGl();
    } catch (const Error& error) {
      SKIP_OR_FAIL(error.what());
    }
  }
  static SceneSpec Spec() {
    SceneSpec spec = EmptyScene();
    const RobotConfig config = RobotConfig::Load(assets::BuiltinRobotFile("rc7"));
    spec.robots.push_back({.name = "arm", .config = config, .control_modes = config.used_modes()});
    spec.objects.push_back(BoxObject("cube", {0.6, 0.2, 0.02}));
    spec.cameras.push_back(
        {.name = "side", .pos = Vec3{0, -3, 0.7}, .fovy = 45, .look_at = Vec3{0, 0, 0.5}});
    return spec;
  }
  static void Key(Viewer& viewer, int key) {
    viewer.Post({.type = InputEvent::kKey, .key = key});
    viewer.Show();
  }
  static void Drag(Viewer& viewer, Eigen::Vector2d from, Eigen::Vector2d to,
                   int button = mjBUTTON_LEFT, bool control = false) {
    viewer.Post({.type = InputEvent::kMove, .x = from.x(), .y = from.y()});
    viewer.Post({.type = InputEvent::kPress,
                 .x = from.x(),
                 .y = from.y(),
                 .button = button,
                 .control = control});
    for (int i = 1; i <= 5; ++i) {
      const Eigen::Vector2d at = from + (to - from) * i / 5.;
      viewer.Post({.type = InputEvent::kMove, .x = at.x(), .y = at.y(), .control = control});
    }
    viewer.Show();
  }
  static void Release(Viewer& viewer, Eigen::Vector2d at, int button = mjBUTTON_LEFT) {
    viewer.Post({.type = InputEvent::kRelease, .x = at.x(), .y = at.y(), .button = button});
    viewer.Show();
  }
  static void Click(Viewer& viewer, const char* section, const char* item, double offset = 0) {
    const auto [x, y] = viewer.PlaceOf(section, item);
    const Eigen::Vector2d at(x + offset, y);
    Drag(viewer, at, at);
    Release(viewer, at);
  }

  Scene scene_;
};

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
  EXPECT_EQ(scene_.Step().status, kStepStopped);
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

TEST_F(Viewers, PanelsSwitchWhatIsShown) {
  Viewer viewer = Viewer::Open(scene_, kInMemory);
  Click(viewer, "View", "Contacts");
  EXPECT_TRUE(viewer.view().flags.contacts);
  Click(viewer, "View", "Contacts");
  EXPECT_FALSE(viewer.view().flags.contacts);
  viewer.ShowPanels("Frames", "");
  Click(viewer, "Frames", "cube");
  EXPECT_TRUE(viewer.view().ShowsFrame({ViewElement::kBody, "cube"}));
  viewer.ShowPanels("Trace", "");
  Click(viewer, "Trace", "arm");
  EXPECT_TRUE(viewer.view().Traces({ViewElement::kTcp, "arm"}));
  viewer.ShowPanels("RTF", "");
  Click(viewer, "RTF", "As fast as possible");
  EXPECT_EQ(viewer.realtime_factor(), 0);
  viewer.ShowPanels("Run", "");
  Click(viewer, "Run", "Close");
  EXPECT_FALSE(viewer.is_running());
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
  EXPECT_EQ(viewer.view().camera(), "side") << "the last of its cameras";
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

TEST_F(Viewers, RecordsOnePictureForEachPartOfASecond) {
  TempDir folder;
  Viewer viewer = Viewer::Open(scene_, kInMemory);
  viewer.set_realtime_factor(0);
  const std::string path = folder / "a.mp4";
  viewer.StartRecording(path, 50, {64, 48}, "side");
  EXPECT_THROW(viewer.StartRecording(path), Error);
  for (int i = 0; i < 50; ++i) viewer.Step();  // 0.1 s
  EXPECT_EQ(viewer.StopRecording(), path);
  EXPECT_NEAR(ReadVideoInfo(path).frames, 5, 1);
  EXPECT_FALSE(viewer.recording());
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

TEST_F(Viewers, DrawsTheSceneBetweenItsPanels) {
  Viewer viewer = Viewer::Open(scene_, kInMemory);
  viewer.view().SetFreeCamera(0.3, 90, -89, {0.6, 0.2, 0.02});
  int width = 0, height = 0;
  const auto pixels = viewer.Pixels(&width, &height);
  ASSERT_EQ(width, 640);
  ASSERT_EQ(pixels.size(), 3u * 640 * 480);
  const uint8_t* middle = pixels.data() + 3 * (240 * 640 + 320);
  EXPECT_GT(middle[0], 2 * middle[2]) << "the orange cube";
}

TEST_F(Viewers, OneViewerStepsAScene) {
  Viewer viewer = Viewer::Open(scene_, kInMemory);
  EXPECT_THROW(Viewer::Open(scene_, kInMemory), Error);
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

TEST_F(Viewers, WithoutADisplayTheErrorNamesWhatToDo) {
  const ScopedEnv no_display("DISPLAY", ":nowhere");
  const ScopedEnv no_wayland("WAYLAND_DISPLAY", "");
  try {
    Viewer::Open(scene_);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("viewer: no window"));
    EXPECT_THAT(error.what(), ::testing::HasSubstr("apt install"));
  }
}

}  // namespace
}  // namespace robocell
