#include "robocell/scenes/visibility.h"

#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

// A cube of 10 cm at the origin, and a wall beside the way to it.
Scene SceneWithWall(double wall_y) {
  SceneSpec spec{.name = "visibility", .timestep = 0.002, .add_floor = false, .add_skybox = false};
  const auto add = [&](const char* name, const Vec3& size, const Vec3& pos) {
    spec.objects.push_back({.name = name,
                            .shape = Shape::kBox,
                            .size = size,
                            .rgba = Vec4{1, 0, 0, 1},
                            .mass = 1,
                            .friction = Vec3{1, 0.02, 0.001},
                            .pos = pos,
                            .fixed = true});
  };
  add("cube", {0.05, 0.05, 0.05}, {0, 0, 0});
  add("wall", {0.01, 0.5, 0.5}, {0.5, wall_y, 0});
  Scene scene = Scene::Build(spec);
  scene.Reset();
  return scene;
}

// It looks along -x at the cube from a metre away.
double ShareIn(const Scene& scene, const Eigen::Vector3d& lookat = Eigen::Vector3d::Zero()) {
  const FreeCamera camera{LookAt({1, 0, 0}, lookat), 45};
  const std::string body = scene.compiled()->object("cube").root_body;
  return VisibleShare(scene, body, ComputeCamera(scene.model(), scene.data(), camera, 320, 240));
}

TEST(VisibleShare, IsOneInTheOpen) { EXPECT_DOUBLE_EQ(ShareIn(SceneWithWall(2)), 1); }

TEST(VisibleShare, IsZeroBehindAWall) { EXPECT_DOUBLE_EQ(ShareIn(SceneWithWall(0)), 0); }

TEST(VisibleShare, IsAboutAHalfBehindHalfAWall) {
  const double share = ShareIn(SceneWithWall(0.5));  // it covers y > 0
  EXPECT_GT(share, 0.3);
  EXPECT_LT(share, 0.8);
}

TEST(VisibleShare, IsZeroOutsideTheImage) {
  EXPECT_DOUBLE_EQ(ShareIn(SceneWithWall(2), {1, 5, 0}), 0);
}

TEST(VisibleShare, RejectsAnUnknownBody) {
  const Scene scene = SceneWithWall(2);
  const FreeCamera camera{LookAt({1, 0, 0}, {0, 0, 0}), 45};
  const CameraModel model = ComputeCamera(scene.model(), scene.data(), camera, 320, 240);
  ExpectThrow<NotFoundError>([&] { VisibleShare(scene, "cubee", model); }, "cubee");
}

}  // namespace
}  // namespace robocell::internal
