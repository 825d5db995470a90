#include "robocell/render/view_cull.h"

#include <gtest/gtest.h>

#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/rng.h"
#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/forward.h"
#include "robocell/mujoco/owners.h"
#include "robocell/render/gl_context.h"
#include "robocell/render/gl_drawing.h"
#include "robocell/render/mjv_scene.h"
#include "robocell/testing/skip.h"

namespace robocell::internal {
namespace {

constexpr int kWide = 48, kHigh = 36;

// Every shape, rotated and moved, and a mesh whose own centre is elsewhere.
constexpr char kShapes[] = R"(<mujoco>
  <asset><mesh name="wedge" vertex="0 0 0  .3 0 0  0 .2 0  0 0 .4  .3 0 .1"/></asset>
  <worldbody>
    <light pos="0 0 4"/>
    <geom type="plane" size="3 3 .1" pos="0 0 -1" rgba=".2 .3 .2 1"/>
    <geom type="sphere" size=".2" pos=".8 0 0" rgba="1 0 0 1"/>
    <geom type="capsule" size=".05 .4" pos="-.8 .1 0" euler="40 20 0" rgba="0 1 0 1"/>
    <geom type="cylinder" size=".1 .3" pos="0 .9 .1" euler="0 70 10" rgba="0 0 1 1"/>
    <geom type="ellipsoid" size=".1 .2 .3" pos="0 -.9 0" euler="15 0 60" rgba="1 1 0 .5"/>
    <geom type="box" size=".1 .3 .05" pos="0 0 .9" euler="30 30 30" rgba="0 1 1 1"/>
    <geom type="mesh" mesh="wedge" pos=".5 .5 -.5" euler="10 80 0" rgba="1 0 1 1"/>
    <geom type="mesh" mesh="wedge" pos="-.5 -.6 .4" euler="100 0 50" rgba="1 .5 0 1"/>
    <site name="mark" type="box" size=".1 .1 .1" pos=".6 -.6 0" rgba="1 1 1 1"/>
  </worldbody></mujoco>)";

class ViewCulling : public testing::Test {
 protected:
  void SetUp() override {
    try {
      context_ = GlContext::Create();
    } catch (const Error& error) {
      SKIP_OR_FAIL(error.what());
    }
    model_ = Compile(ParseXmlString(kShapes).get());
    data_ = MakeData(model_.get());
    Forward(model_.get(), data_.get());
    scene_ = std::make_unique<MjvScene>(model_.get());
    cull_ = ViewCull(model_.get());
  }

  void Update(const CameraModel& camera) {
    mjvOption option;
    mjv_defaultOption(&option);
    mjvCamera user;
    mjv_defaultCamera(&user);
    user.type = mjCAMERA_USER;
    scene_->SetCamera(camera);
    mjv_updateScene(model_.get(), data_.get(), &option, nullptr, &user, mjCAT_ALL, scene_->get());
    scene_->get()->flags[mjRND_SHADOW] = scene_->get()->flags[mjRND_REFLECTION] = 0;
  }

  std::vector<uint8_t> Picture(MjrContext& drawing) {
    std::vector<uint8_t> rgb(3 * kWide * kHigh);
    drawing.Draw(scene_->get(), kWide, kHigh);
    drawing.Read(kWide, kHigh, rgb.data(), nullptr);
    return rgb;
  }

  CameraModel See(const CameraView& view) const {
    return ComputeCamera(model_.get(), data_.get(), view, kWide, kHigh);
  }

  ModelPtr model_;
  DataPtr data_;
  std::unique_ptr<GlContext> context_;
  std::unique_ptr<MjvScene> scene_;
  ViewCull cull_;
};

TEST_F(ViewCulling, ChangesNoPixelFromAnyView) {
  GlContext::Current current(*context_);
  MjrContext drawing(model_.get(), 0, 0);
  Rng rng = Rng::Stream(1);
  int all = 0, left = 0;
  for (int i = 0; i < 400; ++i) {
    const Eigen::Vector3d eye(rng.Uniform(-2, 2), rng.Uniform(-2, 2), rng.Uniform(-0.8, 2));
    const Eigen::Vector3d target(rng.Uniform(-2, 2), rng.Uniform(-2, 2), rng.Uniform(-1, 2));
    CameraModel camera = See(FreeCamera{LookAt(eye, target), rng.Uniform(10, 100)});
    camera.orthographic = i % 4 == 0;
    if (camera.orthographic) camera.fx = camera.fy = rng.Uniform(20, 200);
    camera.near_m = i % 3 == 0 ? 0.7 : 0.02;
    camera.far_m = i % 5 == 0 ? 1.5 : 20;
    Update(camera);
    const std::vector<uint8_t> whole = Picture(drawing);
    all += scene_->get()->ngeom;
    cull_.DropUnseen(camera, scene_->get());
    left += scene_->get()->ngeom;
    EXPECT_EQ(Picture(drawing), whole) << "view " << i;
  }
  EXPECT_LT(left, 0.8 * all) << "most views show a part only";
}

TEST_F(ViewCulling, VisibleGeomsKeepTheirOrderAndIds) {
  const Eigen::Vector3d eye(0, -0.2, 0);
  const CameraModel camera = See(FreeCamera{LookAt(eye, {1, -0.2, 0}), 60});
  Update(camera);
  mjvScene* scene = scene_->get();
  std::vector<int> ids;
  for (int i = 0; i < scene->ngeom; ++i) ids.push_back(scene->geoms[i].segid);
  cull_.DropUnseen(camera, scene);
  std::vector<int> kept;
  for (int i = 0; i < scene->ngeom; ++i) kept.push_back(scene->geoms[i].segid);
  EXPECT_EQ(kept, (std::vector<int>{ids[0], ids[1], ids[6], ids.back()}))
      << "the floor, the sphere ahead, the mesh beside it, the site, which always stays";
}

TEST_F(ViewCulling, UsesDrawnRatherThanCompiledSizes) {
  const CameraModel camera = See(FreeCamera{LookAt({0, 0, 0.3}, {0, 0, 5}), 20});
  Update(camera);
  const int all = scene_->get()->ngeom;
  cull_.DropUnseen(camera, scene_->get());
  const int few = scene_->get()->ngeom;
  EXPECT_LT(few, all);
  model_->geom_size[3 * 1] = 1.0;  // the sphere, which now reaches into the view
  Update(camera);
  cull_.DropUnseen(camera, scene_->get());
  EXPECT_EQ(scene_->get()->ngeom, few + 1);
}

}  // namespace
}  // namespace robocell::internal
