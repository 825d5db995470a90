#include "robocell/scene/place_camera.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>

#include "robocell/base/error.h"
#include "robocell/base/rng.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

SceneSpec SceneWithCameras() {
  SceneSpec spec = EmptyScene();
  spec.objects.push_back(BoxObject("box", {0, 0, 0.02}));
  spec.cameras.push_back({.name = "side", .pos = Vec3{1, 0, 1}, .fovy = 45});
  spec.cameras.push_back(
      {.name = "on_box", .pos = Vec3{0, 0, 0.1}, .fovy = 60, .attach_to = Body("box")});
  spec.cameras.push_back({.name = "of_rig", .pos = Vec3{0, 0, 1}, .fovy = 60, .attach_to = Root()});
  return spec;
}

TEST(PlaceCamera, ASceneBuiltFromTheSpecHasTheCameraThereToo) {
  for (int seed = 0; seed < 5; ++seed) {
    Rng rng = Rng::Stream(seed, "place camera");
    const auto random = [&] {
      return Pose::FromRotvec({rng.Uniform(-1, 1), rng.Uniform(-1, 1), rng.Uniform(-1, 1)},
                              {rng.Uniform(-2, 2), rng.Uniform(-2, 2), rng.Uniform(-1, 1)});
    };
    Scene scene = Scene::Build(SceneWithCameras());
    scene.Reset();
    PlaceCamera(scene, "side", random(), rng.Uniform(20, 100));
    PlaceCamera(scene, "on_box", random(), rng.Uniform(20, 100));
    scene.SyncPoses();
    Scene again = Scene::Build(scene.spec());
    again.Reset();
    const mjModel *m = scene.model(), *n = again.model();
    for (const char* name : {"side", "on_box"}) {
      const int i = FindId(m, mjOBJ_CAMERA, name), k = FindId(n, mjOBJ_CAMERA, name);
      ASSERT_EQ(m->cam_bodyid[i], n->cam_bodyid[k]);
      EXPECT_EQ(m->cam_fovy[i], n->cam_fovy[k]);
      EXPECT_TRUE(scene.camera_pose(name).is_close(again.camera_pose(name), 1e-12, 1e-12));
    }
  }
}

// The engine leaves out what sleeps and, then, what never moves.
TEST(PlaceCamera, MovesCamerasOnBodiesThatSleepOrNeverMove) {
  SceneSpec spec = SceneWithCameras();
  spec.options.enable = {"sleep"};
  Scene scene = Scene::Build(spec);
  EXPECT_TRUE(scene.StepN(1000).ok());
  const int* trees = scene.data()->tree_asleep;
  ASSERT_TRUE(std::all_of(trees, trees + scene.model()->ntree, [](int t) { return t >= 0; }));
  const Pose box = scene.body_pose("box");
  const Pose place = Pose::FromRpy({0.4, -0.3, 1.2}, {0.1, 0.2, 0.3});
  for (const bool forward : {false, true}) {
    const Pose pose = forward ? place : place * place;
    PlaceCamera(scene, "side", pose, 50);
    PlaceCamera(scene, "on_box", pose, 50);
    if (forward)
      scene.Forward();
    else
      scene.SyncPoses();
    EXPECT_TRUE(scene.camera_pose("side").is_close(pose, 1e-12, 1e-12));
    EXPECT_TRUE(scene.camera_pose("on_box").is_close(box * pose, 1e-12, 1e-12));
  }
}

TEST(PlaceCamera, RejectsCamerasThatItCannotMove) {
  Scene scene = Scene::Build(SceneWithCameras());
  ExpectThrow<NotFoundError>([&] { PlaceCamera(scene, "sid", {}, 45); }, "Did you mean 'side'?");
  ExpectThrow<ArgumentError>([&] { PlaceCamera(scene, "of_rig", {}, 45); },
                             "attached to the world or to a body");
}

}  // namespace
}  // namespace robocell::internal
