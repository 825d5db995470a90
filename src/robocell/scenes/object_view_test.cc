#include "robocell/scenes/object_view.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mjmodel.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>
#include <vector>
#include <Eigen/Core>

#include "robocell/base/error.h"
#include "robocell/base/rng.h"
#include "robocell/math/pose.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

// Two boxes, of which the second hides some of the first for a camera that looks along -x.
Scene TwoBoxes(double offset) {
  SceneSpec spec{.name = "boxes", .timestep = 0.002, .add_floor = false, .add_skybox = false};
  for (const auto& [name, x, y] : {std::tuple{"far", 0.0, 0.0}, {"near", 0.5, offset}}) {
    SceneObject box = BoxObject(name, {x, y, 0});
    box.size = Vec3{0.1, 0.1, 0.1};
    box.fixed = true;
    spec.objects.push_back(box);
  }
  Scene scene = Scene::Build(spec);
  scene.Reset();
  return scene;
}

CameraView AlongX() { return FreeCamera{LookAt({2, 0, 0}, {0, 0, 0}), 30}; }

ObjectView See(const Scene& scene, const std::string& name, int width, int height) {
  BodyImages images;
  return ViewOfObject(scene, BodiesOf(scene, name, "test"), AlongX(), width, height, 5, images);
}

TEST(ObjectView, PixelsAreThoseOfTheProjectedFace) {
  // Sizes of the tutorials, and odd ones: the vertical field of view stays, pixels are square.
  for (const auto& [width, height] :
       {std::pair{640, 368}, {624, 352}, {333, 217}, {64, 200}, {101, 31}}) {
    const Scene scene = TwoBoxes(5);
    const ObjectView seen = See(scene, "far", width, height);
    const CameraModel camera = ComputeCamera(scene.model(), scene.data(), AlongX(), width, height);
    const double side = 0.2 * camera.fy / 1.9;  // of the near face, pixels
    EXPECT_DOUBLE_EQ(camera.fx, camera.fy);
    EXPECT_NEAR(seen.high[0] - seen.low[0] + 1, side, 1.01) << width << "x" << height;
    EXPECT_NEAR(seen.high[1] - seen.low[1] + 1, side, 1.01);
    EXPECT_NEAR(0.5 * (seen.low[0] + seen.high[0]), camera.cx, 0.51);
    EXPECT_NEAR(0.5 * (seen.low[1] + seen.high[1]), camera.cy, 0.51);
    EXPECT_EQ(seen.pixels, (seen.high[0] - seen.low[0] + 1) * (seen.high[1] - seen.low[1] + 1));
    EXPECT_DOUBLE_EQ(seen.share, 1);
  }
}

TEST(ObjectView, WhatIsHiddenHasFewerPixelsAndASmallerShare) {
  const ObjectView open = See(TwoBoxes(5), "far", 160, 120);
  const ObjectView half = See(TwoBoxes(0.1), "far", 160, 120);
  const ObjectView none = See(TwoBoxes(0), "far", 160, 120);
  EXPECT_GT(half.pixels, 0);
  EXPECT_LT(half.pixels, 0.8 * open.pixels);
  EXPECT_LT(half.share, 0.9);
  EXPECT_EQ(none.pixels, 0);
  EXPECT_EQ(none.share, 0);
  EXPECT_THAT(none.points, IsEmpty());
  EXPECT_THAT(none.low, ElementsAre(0, 0));
  EXPECT_THAT(none.high, ElementsAre(-1, -1));
  EXPECT_THAT(half.points, SizeIs(5));
}

TEST(ObjectView, SuggestsTheNearestName) {
  ExpectThrow<NotFoundError>([] { BodiesOf(TwoBoxes(5), "neer", "scene 'boxes'"); },
                             "scene 'boxes': no object, robot or body 'neer'");
}

// The extents of the geoms along the world's axes are the oracle; they are exact, and the box is not
// for round geoms that are turned.
TEST(BoxOf, ContainsTheGeomsOfItsBodies) {
  SceneSpec spec = EmptyScene();
  SceneObject box = BoxObject("box", {0.4, 0.2, 0.5});
  box.quat = Pose::FromRpy({0, 0, 0}, {0.3, -0.5, 0.7}).quaternion();
  spec.objects.push_back(box);
  Scene scene = Scene::Build(spec);
  scene.Reset();
  scene.Forward();
  const std::optional<WorldBox> found = BoxOf(scene, BodiesOf(scene, "box", "test"));
  ASSERT_TRUE(found);
  const int body = FindId(scene.model(), mjOBJ_BODY, "box");
  for (int i = 0; i < 3; ++i) {
    const auto [low, high] =
        internal::BodyExtent(scene.model(), scene.data(), body, Eigen::Vector3d::Unit(i));
    EXPECT_NEAR(found->low[i], low, 1e-9);
    EXPECT_NEAR(found->high[i], high, 1e-9);
  }
  EXPECT_FALSE(BoxOf(scene, std::vector<bool>(scene.model()->nbody)));
}

TEST(PointsInMask, LieInTheMaskAwayFromItsEdgeAndFromEachOther) {
  for (int seed = 0; seed < 20; ++seed) {
    Rng rng = Rng::Stream(seed, "mask");
    const int width = 20 + static_cast<int>(rng.UniformInt(30)), height = 15 + seed;
    std::vector<uint8_t> mask(static_cast<size_t>(width * height));
    const double cu = rng.Uniform(0, width), cv = rng.Uniform(0, height),
                 radius = rng.Uniform(1, 12);
    for (int v = 0; v < height; ++v) {
      for (int u = 0; u < width; ++u) mask[v * width + u] = std::hypot(u - cu, v - cv) < radius;
    }
    const auto count = std::ranges::count(mask, 1);
    const std::vector<Pixel> points = PointsInMask(mask, width, height, 8);
    EXPECT_LE(points.size(), 8U);
    EXPECT_EQ(points.empty(), count == 0);
    for (size_t i = 0; i < points.size(); ++i) {
      const auto [u, v] = points[i];
      EXPECT_TRUE(mask[v * width + u]);
      for (size_t k = 0; k < i; ++k) EXPECT_NE(points[i], points[k]);
      if (radius > 6 && cu > radius && cu < width - radius && cv > radius && cv < height - radius) {
        EXPECT_LT(std::hypot(u - cu, v - cv), radius - 1);
      }
    }
  }
}

TEST(PointsInMask, RejectsMoreThanCanBeComputedSoon) {
  const std::vector<uint8_t> mask(100, 1);
  EXPECT_THAT(PointsInMask(mask, 10, 10, 10'000), SizeIs(36));
  ExpectThrow<ArgumentError>([&] { PointsInMask(mask, 10, 10, 10'001); },
                             "10001 points of a mask are more than the 10000");
}

TEST(PointsInMask, RejectsAMaskOfAnotherSize) {
  const std::vector<uint8_t> mask(10);
  EXPECT_THAT(PointsInMask(mask, 5, 2, 3), IsEmpty());
  ExpectThrow<ArgumentError>([&] { PointsInMask(mask, 5, 3, 3); },
                             "a mask of 5x3 pixels has 10 values");
}

}  // namespace
}  // namespace robocell
