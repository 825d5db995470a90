#include "robocell/render/scene_recorder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "robocell/assets/resolve.h"
#include "robocell/base/error.h"
#include "robocell/media/video_info.h"
#include "robocell/render/testing/videos.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/skip.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;

const VideoRecorderOptions kLittle{.width = 64, .height = 48, .fps_num = 30};
constexpr double kMiddle = 23.5;  // row of an image of 48

// A red ball a metre above the floor, and a camera beside it.
class FollowingRecorder : public testing::Test {
 protected:
  FollowingRecorder() : scene_(Scene::Build(Spec())) {}
  void SetUp() override {
    try {
      SceneRecorder(scene_, folder_ / "probe.mp4", kLittle);
    } catch (const Error& error) {
      SKIP_OR_FAIL(error.what());
    }
  }
  static SceneObject Ball() {
    SceneObject ball = BoxObject("ball", {0, 0, 1});
    ball.shape = Shape::kSphere;
    ball.size = Vec3{0.2, 0, 0};
    ball.rgba = Vec4{1, 0, 0, 1};
    return ball;
  }
  static SceneSpec Spec() {
    SceneSpec spec = EmptyScene();
    spec.add_skybox = false;
    spec.objects.push_back(Ball());
    spec.cameras.push_back(
        {.name = "side", .pos = Vec3{0, -3, 0.7}, .fovy = 45, .look_at = Vec3{0, 0, 0.7}});
    return spec;
  }

  TempDir folder_;
  Scene scene_;
};

TEST_F(FollowingRecorder, ContinuesWhenObjectsComeAndGo) {
  SceneRecorder video(scene_, folder_ / "a.mp4", kLittle);
  video.SetTrackingCamera("ball", 3, 90, 0);
  video.RecordFrame();
  for (int i = 0; i < 2; ++i) {  // the model after a removal has the signature of the first one
    SceneObject post = BoxObject("a_post", {1, 0, 0.02});
    post.fixed = true;
    scene_.AddObject(post);
    video.RecordFrame();
    scene_.RemoveObject("a_post");
    video.RecordFrame();
  }
  scene_.AddObject(BoxObject("box", {1, 0, 0.02}));
  video.UseCamera("side");
  video.RecordFrame();
  video.Finish();
  const std::vector<double> rows = RowsOfRed(video.path());
  ASSERT_EQ(rows.size(), 6u);
  for (size_t i = 0; i < 5; ++i) EXPECT_NEAR(rows[i], kMiddle, 1) << i;
  EXPECT_LT(rows[5], kMiddle - 3) << "the camera beside it looks below it";
}

TEST_F(FollowingRecorder, ReportsAMissingTrackedBodyUntilItReturns) {
  SceneRecorder video(scene_, folder_ / "a.mp4", kLittle);
  video.SetTrackingCamera("ball", 3, 90, 0);
  video.RecordFrame();
  const std::string gone = "a.mp4': no body 'ball'. Its bodies: world";
  scene_.RemoveObject("ball");
  for (int i = 0; i < 2; ++i) ExpectThrow<NotFoundError>([&] { video.RecordFrame(); }, gone);
  scene_.AddObject(Ball());
  video.RecordFrame();  // there again
  scene_.RemoveObject("ball");
  ExpectThrow<NotFoundError>([&] { video.RecordFrame(); }, gone);
  video.UseCamera("side");
  video.RecordFrame();
  ExpectThrow<NotFoundError>([&] { video.UseCamera("Tracking"); }, gone);
  video.RecordFrame();  // with the camera beside it still
  std::vector<Marker> markers;
  AddPoint(markers, {0, 0, 1}, 0.2, {1, 0, 0, 1});
  video.SetMarkers(markers);
  video.RecordFrame();
  video.SetMarkers({});
  scene_.AddObject(Ball());
  video.UseCamera("Tracking");
  video.RecordFrame();
  EXPECT_EQ(video.frames(), 6);
  video.Finish();
  const std::vector<double> rows = RowsOfRed(video.path());
  ASSERT_EQ(rows.size(), 6u);
  for (const size_t i : {0, 1, 5}) EXPECT_NEAR(rows[i], kMiddle, 1) << i;
  for (const size_t i : {2, 3}) EXPECT_TRUE(std::isnan(rows[i])) << i;
  EXPECT_LT(rows[4], kMiddle - 3);
}

TEST_F(FollowingRecorder, HasTheCamerasOfRobotsAndOfTheScene) {
  SceneSpec spec = Spec();
  spec.robots.push_back({.config = RobotConfig::Load(assets::BuiltinRobotFile("rc7")),
                         .prefix = "r_",
                         .pos = {0, 1.5, 0}});
  const Scene scene = Scene::Build(spec);
  SceneRecorder video(scene, folder_ / "a.mp4", kLittle);
  const std::vector<std::string> names = video.camera_names();
  EXPECT_THAT(names,
              ElementsAre("Current", "Free", "Tracking", "r_exo_camera", "r_wrist_camera", "side"));
  video.SetFreeCamera(3, 90, 0, {0, 0, 0.7});
  video.SetTrackingCamera("ball", 3, 90, 0);
  for (const std::string& name : names) {
    video.UseCamera(name);
    video.RecordFrame();
  }
  video.UseCamera("Current");
  video.RecordFrame();
  video.Finish();

  std::vector<std::vector<uint8_t>> expected;
  const auto renderer = MakeRenderer();
  renderer->SetModel(scene.model());
  for (const char* name : {"r_exo_camera", "r_wrist_camera", "side"}) {
    expected.emplace_back(3 * 64 * 48);
    renderer->Render(
        scene.data(),
        {.camera = NamedCamera(scene.model(), name, "test"), .width = 64, .height = 48},
        {.rgb = expected.back()});
  }
  const std::vector<std::vector<uint8_t>> frames = FramesOf(video.path());
  ASSERT_EQ(frames.size(), 7u);
  for (size_t i = 0; i < expected.size(); ++i) {
    EXPECT_GT(Psnr(frames[3 + i], expected[i]), 28) << names[3 + i];
    EXPECT_LT(Psnr(frames[3 + i], expected[(i + 1) % 3]), 20) << names[3 + i];
  }
  EXPECT_GT(Psnr(frames[6], expected[2]), 28) << "the current one";
  const std::vector<double> rows = RowsOfRed(video.path());
  EXPECT_NEAR(rows[0], kMiddle, 1) << "current: it tracks";
  EXPECT_LT(rows[1], kMiddle - 3) << "free: it looks below the ball";
  EXPECT_NEAR(rows[2], kMiddle, 1) << "tracking";
}

TEST_F(FollowingRecorder, AnUnknownCameraErrorListsTheCameras) {
  SceneRecorder video(scene_, folder_ / "a.mp4", kLittle);
  ExpectThrow<NotFoundError>(
      [&] { video.UseCamera("sied"); },
      "a.mp4': no camera 'sied'. Its cameras: Current, Free, Tracking, side. Did you mean 'side'?");
  ExpectThrow<NotFoundError>([&] { video.UseCamera("free"); }, "Did you mean 'Free'?");
  ExpectThrow<ArgumentError>([&] { SceneRecorder(scene_, folder_ / "odd.mp4", {.width = 63}); },
                             "63");
}

TEST_F(FollowingRecorder, FinishesTheFileAfterTheSceneIsClosed) {
  SceneRecorder video(scene_, folder_ / "a.mp4", kLittle);
  video.UseCamera("side");
  video.RecordFrame();
  scene_.Close();
  const std::string closed = "scene 'test' is closed";
  ExpectThrow<ClosedError>([&] { video.RecordFrame(); }, closed);
  ExpectThrow<ClosedError>([&] { video.UseCamera("Free"); }, closed);
  ExpectThrow<ClosedError>([&] { video.UseCamera(FreeCamera{}); }, closed);
  ExpectThrow<ClosedError>([&] { video.SetFreeCamera(3, 90, 0, {0, 0, 0}); }, closed);
  ExpectThrow<ClosedError>([&] { video.SetTrackingCamera("ball", 3, 90, 0); }, closed);
  ExpectThrow<ClosedError>([&] { video.camera_names(); }, closed);
  EXPECT_EQ(video.frames(), 1);
  video.Finish();
  EXPECT_EQ(ReadVideoInfo(video.path()).frames, 1);
}

}  // namespace
}  // namespace robocell
