// Tests how the engine's list of elements becomes instances for the kernels.
#include "robocell/render/soft_scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "robocell/mujoco/compile.h"

namespace robocell::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

// A camera 5 m above the origin looks down at what a test puts into the list.
class SoftSceneTest : public ::testing::Test {
 protected:
  SoftSceneTest()
      : model_(Compile(
            ParseXmlString("<mujoco><worldbody><geom size='1'/></worldbody></mujoco>").get())) {
    mjv_defaultScene(&list_);
    mjv_makeScene(model_.get(), &list_, 100);
    camera_ = {.width = 64,
               .height = 48,
               .camera_in_world = Pose(Eigen::Vector3d(0, 0, 5)),
               .fx = 50,
               .fy = 50,
               .cx = 31.5,
               .cy = 23.5,
               .near_m = 0.1,
               .far_m = 50};
    scene_.SetModel(model_.get(), {});
  }
  ~SoftSceneTest() override { mjv_freeScene(&list_); }

  // Adds a box of 20 cm at `pos`.
  void AddBox(double x, double y, double z, float alpha = 1) {
    const mjtNum size[3] = {0.1, 0.1, 0.1}, pos[3] = {x, y, z};
    const float rgba[4] = {0.2f, 0.4f, 0.6f, alpha};
    mjvGeom& geom = list_.geoms[list_.ngeom];
    mjv_initGeom(&geom, mjGEOM_BOX, size, pos, nullptr, rgba);
    geom.segid = list_.ngeom++;
  }
  void Update(const std::vector<int32_t>& bodies = {}) {
    scene_.Update(model_.get(), list_, bodies, camera_, {.sky = false});
  }
  std::vector<int> BodiesDrawn() const {
    std::vector<int> bodies;
    for (const SoftInstance& instance : scene_.instances()) bodies.push_back(instance.body);
    return bodies;
  }

  ModelPtr model_;
  mjvScene list_;
  CameraModel camera_;
  SoftScene scene_;
};

TEST_F(SoftSceneTest, TheViewIsTheCameras) {
  Update();
  const SoftView& view = scene_.view();
  EXPECT_EQ(view.width, 64);
  EXPECT_EQ(view.height, 48);
  EXPECT_EQ(view.fx, 50);
  EXPECT_EQ(view.cx, 31.5f);
  EXPECT_EQ(view.per_fx, 1 / 50.0f);
  EXPECT_EQ(view.far, 50);
  EXPECT_FALSE(view.orthographic);
  EXPECT_THAT(scene_.instances(), IsEmpty());
}

TEST_F(SoftSceneTest, ElementsHaveTheBodiesOfTheirIds) {
  AddBox(0, 0, 0);
  AddBox(0.5, 0, 0);
  Update({7, 3});
  EXPECT_THAT(BodiesDrawn(), ElementsAre(7, 3));
  EXPECT_THAT(scene_.opaque(), ElementsAre(0, 1));
  EXPECT_THAT(scene_.layers(), IsEmpty());
  Update({7});
  EXPECT_THAT(BodiesDrawn(), ElementsAre(7, -1)) << "an id without a body";
}

TEST_F(SoftSceneTest, InstancesAreWhereTheCameraSeesThem) {
  AddBox(0.5, 0.25, 1);
  Update();
  ASSERT_THAT(scene_.instances(), SizeIs(1));
  const float* m = scene_.instances()[0].to_view;
  EXPECT_NEAR(m[3], 0.5, 1e-6);
  EXPECT_NEAR(m[7], 0.25, 1e-6);
  EXPECT_NEAR(m[11], 1 - 5, 1e-6) << "along -z, as of MuJoCo's cameras";
  EXPECT_NEAR(m[0], 0.1, 1e-6) << "a unit box, scaled";
}

TEST_F(SoftSceneTest, WhatIsOutOfViewIsLeftOut) {
  AddBox(0, 0, 0);
  AddBox(10, 0, 0);
  AddBox(0, 0, 6);    // behind the camera
  AddBox(0, 0, -60);  // beyond the far plane
  Update({1, 2, 3, 4});
  EXPECT_THAT(BodiesDrawn(), ElementsAre(1));
}

TEST_F(SoftSceneTest, TransparentElementsAreLayersWithTheNearestFirst) {
  AddBox(0, 0, 0, 0.5f);
  AddBox(0, 0, 2, 0.25f);
  AddBox(0.3, 0, 1);
  AddBox(0, 0, 1, 0.75f);
  Update({0, 1, 2, 3});
  EXPECT_THAT(scene_.opaque(), SizeIs(1));
  std::vector<float> alphas;
  float last = 0;
  for (const SoftScene::Layer& layer : scene_.layers()) {
    alphas.push_back(layer.alpha);
    EXPECT_GE(layer.distance, last);
    EXPECT_EQ(layer.end, layer.first + 1);
    last = layer.distance;
  }
  EXPECT_THAT(alphas, ElementsAre(0.25f, 0.75f, 0.5f));
}

TEST_F(SoftSceneTest, MarkersAreDrawnWithoutABody) {
  AddBox(0, 0, 0);
  const int first = list_.ngeom;
  Update({5});
  AddBox(0.5, 0, 0);
  scene_.AddMarkers(model_.get(), list_, first);
  EXPECT_THAT(BodiesDrawn(), ElementsAre(5, -1));
}

TEST_F(SoftSceneTest, IdsOfInstancesDoNotOverlap) {
  for (int i = 0; i < 5; ++i) AddBox(0.2 * i, 0, 0);
  Update();
  for (size_t i = 1; i < scene_.instances().size(); ++i) {
    const SoftInstance &one = scene_.instances()[i - 1], &next = scene_.instances()[i];
    EXPECT_GE(next.first_id, one.first_id + static_cast<uint32_t>(one.mesh->triangles));
  }
}

TEST_F(SoftSceneTest, OneFaceReflects) {
  SoftThreads threads(1);
  SoftReflection reflection;
  AddBox(0, 0, 0);
  list_.geoms[0].reflectance = 0.5f;
  AddBox(0, 0, 1);
  Update();
  EXPECT_FALSE(scene_.DrawReflection(&threads, &reflection)) << "reflections are off";
  scene_.Update(model_.get(), list_, {}, camera_, {.sky = false, .reflections = true});
  EXPECT_TRUE(scene_.DrawReflection(&threads, &reflection));
}

}  // namespace
}  // namespace robocell::internal
