// Tests skins, flexes, textured meshes and orthographic cameras of `soft` beside OpenGL, and whose
// depths are correct far away.
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <Eigen/Geometry>

#include "robocell/base/error.h"
#include "robocell/mujoco/clip_planes.h"
#include "robocell/mujoco/compile.h"
#include "robocell/render/renderer.h"
#include "robocell/render/testing/soft_images.h"
#include "robocell/testing/skip.h"

namespace robocell {
namespace {

// A cloth with and one without a texture, a soft ball, a skin on two bones that bend, and a mesh
// with texture coordinates of its own, with cameras of both kinds. The skin has no highlights:
// OpenGL computes them at its corners, which are far apart.
constexpr char kKinds[] = R"(<mujoco>
  <asset>
    <texture name="grid" type="2d" builtin="checker" rgb1=".2 .3 .4" rgb2=".9 .8 .5" width="64" height="64"/>
    <material name="grid" texture="grid" texrepeat="2 3"/>
    <material name="dull" rgba=".3 .4 .9 1" specular="0"/>
    <mesh name="roof" vertex="-.3 -.3 0  .3 -.3 0  .3 .3 0  -.3 .3 0  0 0 .4"
      texcoord="0 0  1 0  1 1  0 1  .5 .5" face="0 1 4  1 2 4  2 3 4  3 0 4  0 2 1  0 3 2"/>
  </asset>
  <worldbody>
    <light type="directional" pos="0 0 3" dir=".2 .3 -1" diffuse=".6 .6 .6" castshadow="false"/>
    <geom type="plane" size="3 3 .1" rgba=".6 .6 .6 1"/>
    <camera name="flat" pos="2 -2 2" xyaxes="1 1 0 -.5 .5 1" projection="orthographic" fovy="2.5"/>
    <camera name="above" pos="0 0 3" projection="orthographic" fovy="3"/>
    <camera name="near" pos="1.3 -1.5 1.4" xyaxes="1 .9 0 -.4 .4 1" fovy="60"/>
    <camera name="side" pos="-1.8 .4 .7" xyaxes="-.2 -1 0 .2 0 1" fovy="55"/>
    <body name="roof" pos="-.6 -.6 .2"><freejoint/><geom type="mesh" mesh="roof" material="grid"/></body>
    <flexcomp name="cloth" type="grid" dim="2" count="6 6 1" spacing=".1 .1 .1" pos=".6 .5 .6" radius=".01" rgba=".8 .2 .2 1" euler="20 30 0">
      <contact selfcollide="none"/></flexcomp>
    <flexcomp name="printed" type="grid" dim="2" count="5 5 1" spacing=".1 .1 .1" pos=".5 -.6 .7" radius=".01" material="grid" euler="0 -30 10">
      <contact selfcollide="none"/></flexcomp>
    <flexcomp name="lump" type="grid" dim="3" count="4 3 3" spacing=".1 .1 .1" pos="-.6 .6 .5" radius=".02" rgba=".2 .6 .3 1">
      <contact selfcollide="none"/></flexcomp>
    <body name="lower" pos="0 0 .3"><geom size=".02" rgba="0 0 0 0"/><joint axis="0 1 0"/>
      <body name="upper" pos="0 0 .3"><joint name="bend" axis="0 1 0"/><geom size=".02" rgba="0 0 0 0"/></body></body>
  </worldbody>
  <deformable>
    <skin name="sleeve" material="dull" vertex="-.1 -.1 .2  .1 -.1 .2  .1 .1 .2  -.1 .1 .2
        -.1 -.1 .6  .1 -.1 .6  .1 .1 .6  -.1 .1 .6  -.1 -.1 .9  .1 -.1 .9  .1 .1 .9  -.1 .1 .9"
      face="0 1 5 0 5 4 1 2 6 1 6 5 2 3 7 2 7 6 3 0 4 3 4 7 4 5 9 4 9 8 5 6 10 5 10 9 6 7 11 6 11 10
        7 4 8 7 8 11 8 9 10 8 10 11 0 2 1 0 3 2">
      <bone body="lower" bindpos="0 0 .3" bindquat="1 0 0 0" vertid="0 1 2 3 4 5 6 7" vertweight="1 1 1 1 .5 .5 .5 .5"/>
      <bone body="upper" bindpos="0 0 .6" bindquat="1 0 0 0" vertid="4 5 6 7 8 9 10 11" vertweight=".5 .5 .5 .5 1 1 1 1"/>
    </skin>
  </deformable>
</mujoco>)";

struct Compiled {
  ModelPtr model;
  DataPtr data;

  explicit Compiled(const char* xml, double far = 30) {
    const SpecPtr spec = ParseXmlString(xml);
    internal::SetClipPlanes(spec.get(), 1, 0.01, far);
    model = Compile(spec.get());
    data = MakeData(model.get());
    mj_forward(model.get(), data.get());
  }
};

class SoftDraws : public testing::TestWithParam<std::string> {};

TEST_P(SoftDraws, TheSameAsOpenGl) {
  Compiled kinds(kKinds);
  std::unique_ptr<Renderer> gl, soft = MakeRenderer({.backend = "soft"});
  try {
    gl = MakeRenderer({.backend = "gl"});
  } catch (const Error& error) {
    SKIP_OR_FAIL(error.what());
  }
  gl->SetModel(kinds.model.get());
  soft->SetModel(kinds.model.get());
  const int bend = mj_name2id(kinds.model.get(), mjOBJ_JOINT, "bend");
  for (const double angle : {0.0, 0.8}) {
    kinds.data->qpos[kinds.model->jnt_qposadr[bend]] = angle;
    mj_forward(kinds.model.get(), kinds.data.get());
    const CameraView view = NamedCamera(kinds.model.get(), GetParam(), "the model");
    const SoftImages a = TakeOf(*gl, kinds.data.get(), view),
                     b = TakeOf(*soft, kinds.data.get(), view);
    int ids = 0, depth = 0, shown = 0;
    for (int k = 0; k < kShown; ++k) {
      ids += a.ids[k] != b.ids[k];
      depth += !(std::abs(a.depth[k] - b.depth[k]) <= 1e-3f);
      shown += b.ids[k] == -1 && b.depth[k] > 0;
    }
    EXPECT_GT(shown, 1000) << "flexes and skins have no body";
    EXPECT_LE(ids, 1e-3 * kShown);
    EXPECT_LE(depth, 1e-3 * kShown);
    EXPECT_GE(Similarity(a.rgb, b.rgb), 0.95);
    if (std::getenv("ROBOCELL_TEST_VERBOSE")) {
      std::printf("%s at %g: ids differ in %.4f %%, depth in %.4f %%, similarity %.4f\n",
                  GetParam().c_str(), angle, 100.0 * ids / kShown, 100.0 * depth / kShown,
                  Similarity(a.rgb, b.rgb));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Cameras, SoftDraws, testing::Values("near", "side", "flat", "above"),
                         [](const auto& info) { return info.param; });

// The oracle is the engine's ray to a plane. OpenGL's depth buffer has steps that grow with the
// square of the distance; those of `soft` are a share of the distance.
TEST(FarAway, SoftIsWithinAMillimetreOfTheRays) {
  const Compiled floor(R"(<mujoco><worldbody>
    <camera name="far" pos="0 0 2" xyaxes="1 0 0 0 .1 1" fovy="45"/>
    <geom type="plane" size="0 0 .1"/></worldbody></mujoco>)");
  double worst[2] = {0, 0}, worst_near[2] = {0, 0};
  const char* names[2] = {"soft", "gl"};
  for (int which = 0; which < 2; ++which) {
    std::unique_ptr<Renderer> renderer;
    try {
      renderer = MakeRenderer({.backend = names[which]});
    } catch (const Error& error) {
      SKIP_OR_FAIL(error.what());
    }
    renderer->SetModel(floor.model.get());
    const SoftImages images =
        TakeOf(*renderer, floor.data.get(), NamedCamera(floor.model.get(), "far", "the model"));
    const Eigen::Vector3d eye = images.camera.camera_in_world.translation();
    for (int y = 0; y < kDown; ++y) {
      for (int x = 0; x < kAcross; x += 40) {
        const Eigen::Vector3d along = images.camera.Unproject({1.0 * x, 1.0 * y}, 1) - eye;
        int geom = -1;
        const double depth = mj_ray(floor.model.get(), floor.data.get(), eye.data(), along.data(),
                                    nullptr, 1, -1, &geom, nullptr);
        if (depth < 0.02 || depth > 29) continue;
        const double error = std::abs(depth - images.depth[y * kAcross + x]);
        double& most = depth < 4 ? worst_near[which] : worst[which];
        most = std::max(most, error);
      }
    }
  }
  if (std::getenv("ROBOCELL_TEST_VERBOSE")) {
    std::printf(
        "largest depth errors, mm: below 4 m soft %.4f gl %.4f; up to 29 m soft %.4f gl %.4f\n",
        1e3 * worst_near[0], 1e3 * worst_near[1], 1e3 * worst[0], 1e3 * worst[1]);
  }
  EXPECT_LT(worst_near[0], 1e-3);
  EXPECT_LT(worst_near[1], 1e-3);
  EXPECT_LT(worst[0], 1e-3);
  EXPECT_GT(worst[1], worst[0]) << "OpenGL may judge everywhere in SoftAgrees.WithOpenGl";
}

}  // namespace
}  // namespace robocell
