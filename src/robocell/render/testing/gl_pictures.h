// For tests only: a small scene and pictures of it for the parts of the back end `gl`.
#pragma once

#include <mujoco/mujoco.h>

#include <cstdint>
#include <vector>

#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/owners.h"
#include "robocell/render/drawn_scene.h"
#include "robocell/render/gl_painter.h"

namespace robocell::internal {

inline constexpr char kBallsAndMesh[] = R"(<mujoco>
  <asset>
    <texture name="sky" type="skybox" builtin="gradient" rgb1=".3 .5 .7" rgb2="0 0 0" width="32" height="192"/>
    <texture name="grid" type="2d" builtin="checker" rgb1=".2 .3 .4" rgb2=".7 .8 .9" width="64" height="64"/>
    <material name="grid" texture="grid" texrepeat="4 4" reflectance=".4"/>
    <mesh name="tetra" vertex="0 0 0  .4 0 0  0 .4 0  0 0 .4"/>
  </asset>
  <worldbody>
    <light pos="0 0 3" dir="0 .3 -1" castshadow="true"/>
    <geom type="plane" size="0 0 .1" material="grid"/>
    <body pos="0 0 .5"><geom size=".2" rgba="1 0 0 1"/></body>
    <body pos=".5 0 .3"><geom type="mesh" mesh="tetra" rgba="0 .6 1 1"/></body>
    <body pos="-.5 .1 .3"><geom type="box" size=".1 .2 .3" rgba="0 1 0 .5"/></body>
  </worldbody></mujoco>)";

struct RawImages {
  std::vector<uint8_t> rgb, codes;
  std::vector<float> depth;
  bool operator==(const RawImages&) const = default;
};

// A scene and the list of what one camera sees of it.
class ListedScene {
 public:
  explicit ListedScene(const char* xml = kBallsAndMesh)
      : model_(Compile(ParseXmlString(xml).get())),
        data_(MakeData(model_.get())),
        drawn_({.keep_unseen = true}) {
    drawn_.SetModel(model_.get());
  }
  mjModel* model() { return model_.get(); }

  // Returns a picture into `images`, which it resizes; valid until the next one.
  GlPicture Picture(double azimuth, int width, int height, RawImages& images) {
    const OrbitCamera view{
        .lookat = {0, 0, 0.3}, .distance = 2, .azimuth = azimuth, .elevation = -25};
    drawn_.Update(data_.get(), {.camera = view, .width = width, .height = height});
    const auto pixels = static_cast<size_t>(width) * static_cast<size_t>(height);
    images.rgb.assign(3 * pixels, 0);
    images.codes.assign(3 * pixels, 0);
    images.depth.assign(pixels, 0);
    drawn_.scene()->flags[mjRND_SHADOW] = drawn_.scene()->flags[mjRND_REFLECTION] = 1;
    return {.scene = drawn_.scene(),
            .exact_geoms = drawn_.scene()->ngeom,
            .width = width,
            .height = height,
            .rgb = images.rgb,
            .codes = images.codes,
            .depth = images.depth};
  }

 private:
  ModelPtr model_;
  DataPtr data_;
  DrawnScene drawn_;
};

// Styles with and without effects: with samples, depth and codes have a buffer of their own.
inline constexpr GlStyle kGlStyles[] = {{}, {.multisamples = 4, .shadow_size = 256}};

}  // namespace robocell::internal
