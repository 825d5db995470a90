#include "robocell/render/stream_camera.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/base/error.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

class StreamCamera : public ::testing::Test {
 protected:
  Scene Cell(bool two_robots, const std::string& scene_camera = "") {
    SceneSpec spec = EmptyScene();
    RobotConfig arm = ArmConfig(folder_.Write("arm", kTwoJointArm));
    arm.cameras.push_back(
        {.name = "wrist_camera", .pos = Vec3{}, .fovy = 45, .attach_to = Site("flange")});
    spec.robots.push_back({.name = "a", .config = arm, .prefix = "a/"});
    if (two_robots)
      spec.robots.push_back({.name = "b", .config = arm, .prefix = "b/", .pos = {0, 2, 0}});
    if (!scene_camera.empty())
      spec.cameras.push_back({.name = scene_camera, .pos = Vec3{1, 0, 1}, .fovy = 45});
    return Scene::Build(spec);
  }

  static CameraConfig Stream(const std::string& camera) {
    return {.name = "wrist", .camera = camera};
  }

 private:
  ModelFolder folder_;
};

TEST_F(StreamCamera, PrefersTheExactName) {
  EXPECT_EQ(FindCameraName(Cell(false), Stream("wrist_camera")), "a/wrist_camera");
  EXPECT_EQ(FindCameraName(Cell(false, "wrist_camera"), Stream("wrist_camera")), "wrist_camera");
  EXPECT_EQ(FindCameraName(Cell(true), Stream("b/wrist_camera")), "b/wrist_camera");
}

TEST_F(StreamCamera, RequiresTheRobotNameIfAmbiguous) {
  ExpectThrow<ArgumentError>([&] { FindCameraName(Cell(true), Stream("wrist_camera")); },
                             "stream 'wrist': camera 'wrist_camera' is one of a/wrist_camera, "
                             "b/wrist_camera; write the full name");
}

TEST_F(StreamCamera, AMissingCameraErrorListsTheCameras) {
  ExpectThrow<NotFoundError>(
      [&] { FindCameraName(Cell(false, "top"), Stream("wrist_camra")); },
      "stream 'wrist': no camera 'wrist_camra'. Its cameras: top, wrist_camera. Did you mean "
      "'wrist_camera'?");
}

TEST_F(StreamCamera, FreeShowsTheWholeModelUnlessACameraHasThatName) {
  const Scene scene = Cell(false);
  const auto view = std::get<OrbitCamera>(ViewOfStream(scene, Stream("Free")));
  const OrbitCamera first = InitialView(scene.model());
  EXPECT_EQ(view.lookat, first.lookat);
  EXPECT_EQ(view.distance, first.distance);
  const Scene named = Cell(false, "Free");
  EXPECT_TRUE(std::holds_alternative<ModelCamera>(ViewOfStream(named, Stream("Free"))));
}

TEST_F(StreamCamera, FollowsABody) {
  const Scene scene = Cell(true);
  CameraConfig stream{.name = "chase", .follow = scene.body_names().back()};
  const auto view = std::get<TrackingCamera>(ViewOfStream(scene, stream));
  EXPECT_EQ(view.body, scene.model()->nbody - 1);
  stream.follow = "nobody";
  ExpectThrow<NotFoundError>([&] { ViewOfStream(scene, stream); }, "stream 'chase'");
}

TEST_F(StreamCamera, FollowsAnObjectWhateverItsBodyIsCalled) {
  SceneSpec spec = EmptyScene();
  spec.objects.push_back({.name = "target", .mjcf_path = "mug"});
  const Scene scene = Scene::Build(spec);
  const std::string body = scene.compiled()->object("target").root_body;
  ASSERT_NE(body, "target") << "a model's body keeps its name, behind that of the object";
  CameraConfig stream{.name = "chase", .follow = "target"};
  const auto view = std::get<TrackingCamera>(ViewOfStream(scene, stream));
  EXPECT_EQ(view.body, FindId(scene.model(), mjOBJ_BODY, body));
  stream.follow = "targt";
  ExpectThrow<NotFoundError>([&] { ViewOfStream(scene, stream); },
                             "stream 'chase': no object or body 'targt'");
}

}  // namespace
}  // namespace robocell::internal
