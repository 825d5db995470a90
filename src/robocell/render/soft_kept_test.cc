// Tests pictures of which only the changed blocks are drawn: they have the bytes of a renderer that
// draws all of them, whatever has moved.
#include "robocell/render/soft_kept.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>
#include <Eigen/Geometry>

#include "robocell/base/rng.h"
#include "robocell/mujoco/clip_planes.h"
#include "robocell/mujoco/compile.h"
#include "robocell/render/camera_model.h"
#include "robocell/render/renderer.h"
#include "robocell/spec/render_quality.h"
#include "robocell/testing/instruction_sets.h"
#include "robocell/testing/long_form.h"

namespace robocell::internal {
namespace {

constexpr int kWidth = 118, kHeight = 82;  // the last blocks are not whole
constexpr int kBodies = 7;

// Shapes that move over a floor under the sun, textures of both kinds, something to look through, and
// cameras that stand and that move.
constexpr char kRoom[] = R"(<mujoco>
  <asset>
    <texture name="sky" type="skybox" builtin="gradient" rgb1=".3 .5 .7" rgb2="0 0 .2" width="32" height="192"/>
    <texture name="grid" type="2d" builtin="checker" rgb1=".2 .3 .4" rgb2=".7 .8 .9" width="64" height="64"/>
    <texture name="cube" type="cube" builtin="checker" rgb1=".8 .6 .4" rgb2=".4 .3 .2" width="32" height="32"/>
    <material name="floor" texture="grid" texrepeat="3 3" texuniform="true"/>
    <material name="wood" texture="cube" shininess=".2" specular=".2"/>
    <mesh name="tetra" vertex="0 0 0  .2 0 0  0 .2 0  0 0 .2"/>
  </asset>
  <visual><map haze=".3"/></visual>
  <worldbody>
    <light name="sun" type="directional" pos="0 0 3" dir=".2 .3 -1" diffuse=".5 .5 .5"/>
    <geom type="plane" size="0 0 .1" material="floor"/>
    <geom type="box" size=".5 .02 .3" pos="0 1 .3" rgba=".6 .6 .5 1"/>
    <body mocap="true"><geom size=".15" rgba="1 0 0 1"/></body>
    <body mocap="true"><geom type="capsule" size=".05 .2" rgba="0 1 0 1"/></body>
    <body mocap="true"><geom type="cylinder" size=".1 .15" material="wood"/></body>
    <body mocap="true"><geom type="box" size=".15 .1 .05" material="wood"/></body>
    <body mocap="true"><geom type="mesh" mesh="tetra" rgba=".9 .9 0 1"/></body>
    <body mocap="true"><geom type="capsule" size=".003 .4" rgba=".1 .1 .1 1"/></body>
    <body mocap="true"><geom type="box" size=".1 .1 .1" rgba=".2 .7 .7 .4"/>
      <camera name="moving" pos=".3 -.2 .6" xyaxes="1 .3 0 0 .4 1"/></body>
    <camera name="standing" pos=".3 -1.6 1.1" xyaxes="1 .1 0 0 .6 .8"/>
    <camera name="above" pos="0 .1 2.4" xyaxes="1 .1 0 -.1 1 0" projection="orthographic" fovy="2"/>
    MORE
  </worldbody>
</mujoco>)";

constexpr char kCloth[] = R"(
    <flexcomp name="cloth" type="grid" count="4 4 1" spacing=".1 .1 .1" pos="-.4 .3 .5" dim="2"
              radius=".005" rgba=".8 .3 .8 1"/>)";

// Runs of blocks are coloured as such only without it, under the sun alone.
constexpr char kLamp[] = R"(
    <light name="lamp" type="spot" pos="1 -1 2" dir="-.4 .4 -1" cutoff="40" diffuse=".6 .5 .4"/>)";

// A lamp close to the floor lights nearly half of all directions.
constexpr char kWideLamp[] = R"(
    <light name="wide" type="spot" pos="-.3 .2 .6" dir=".1 .1 -1" cutoff="85" diffuse=".6 .6 .6"/>)";

struct Images {
  std::vector<uint8_t> rgb = std::vector<uint8_t>(size_t{3} * kWidth * kHeight);
  std::vector<float> depth = std::vector<float>(size_t{kWidth} * kHeight);
  std::vector<int32_t> ids = std::vector<int32_t>(size_t{kWidth} * kHeight);

  bool operator==(const Images&) const = default;
};

class Room {
 public:
  Room(const std::string& more, uint64_t seed) : rng_(Rng::Stream(seed, "kept pictures")) {
    std::string xml = kRoom;
    xml.replace(xml.find("MORE"), 4, more);
    const SpecPtr spec = ParseXmlString(xml);
    SetClipPlanes(spec.get(), 1, 0.01, 30);
    model = Compile(spec.get());
    data = MakeData(model.get());
    for (int body = 0; body < kBodies; ++body) Place(body);
  }

  // Changes something, or nothing.
  void Next() {
    const auto kind = static_cast<int>(rng_.Uniform(0, 12));
    const auto body = static_cast<int>(rng_.Uniform(0, kBodies));
    const auto geom = static_cast<int>(rng_.Uniform(0, static_cast<double>(model->ngeom)));
    if (kind < 5) {  // a little, as a robot does from row to row
      for (int k = 0; k < 3; ++k) data->mocap_pos[3 * body + k] += rng_.Uniform(-0.02, 0.02);
    } else if (kind == 5) {
      Place(body);
    } else if (kind == 6) {
      for (int b = 0; b < kBodies; ++b) Place(b);
    } else if (kind == 7) {
      for (int k = 0; k < 3; ++k)
        model->geom_rgba[4 * geom + k] = static_cast<float>(rng_.Uniform(0, 1));
    } else if (kind == 8) {  // something may hide others or not
      model->geom_rgba[4 * geom + 3] = rng_.Uniform(0, 1) < 0.7 ? 1 : 0.5F;
    } else if (kind == 9) {
      model->geom_group[geom] = rng_.Uniform(0, 1) < 0.7 ? 0 : 4;
    } else if (kind == 10) {
      mjtNum* at = model->light_pos + 3 * (model->nlight - 1);
      for (int k = 0; k < 2; ++k) at[k] += rng_.Uniform(-0.2, 0.2);
    } else if (model->nflexvert > 0) {
      for (int k = 0; k < model->nq; ++k) data->qpos[k] = rng_.Uniform(-0.03, 0.03);
    }
  }

  ModelPtr model;
  DataPtr data;

 private:
  void Place(int body) {
    mjtNum* at = data->mocap_pos + 3 * body;
    at[0] = rng_.Uniform(-0.7, 0.7);
    at[1] = rng_.Uniform(-0.6, 0.9);
    at[2] = rng_.Uniform(0, 0.8);
    Eigen::Vector4d turn;
    for (int k = 0; k < 4; ++k) turn[k] = rng_.Uniform(-1, 1);
    turn.normalize();
    std::copy_n(turn.data(), 4, data->mocap_quat + 4 * body);
  }

  Rng rng_;
};

Images Take(Renderer& renderer, const Room& room, const CameraView& view, bool exact = true) {
  Images images;
  RenderOutputs outputs{.rgb = images.rgb};
  if (exact) {
    outputs.depth = images.depth;
    outputs.segmentation = images.ids;
  }
  renderer.Render(room.data.get(), {.camera = view, .width = kWidth, .height = kHeight}, outputs);
  return images;
}

std::unique_ptr<Renderer> Make(const Room& room, const RenderQuality& quality, int threads = 1) {
  auto renderer = MakeRenderer({.backend = "soft", .quality = quality, .threads = threads});
  renderer->SetModel(room.model.get());
  return renderer;
}

constexpr RenderQuality kNoEffects{}, kHardEdges{.shadows = true, .shadow_size = 256},
    kSmoothEdges{.shadows = true, .multisamples = 4, .shadow_size = 512},
    kSamplesOnly{.multisamples = 8},
    kMirror{.shadows = true, .reflections = true, .multisamples = 4, .shadow_size = 256};

// Draws the same states with a renderer that keeps pictures and with one that never does, from all
// cameras in turn.
void ExpectSameBytes(const RenderQuality& quality, const std::string& more, int threads, int states,
                     uint64_t seed) {
  Room room(more, seed);
  if (quality.reflections) room.model->mat_reflectance[0] = 0.3F;
  const auto kept = Make(room, quality, threads), whole = Make(room, quality);
  for (int i = 0; i < states; ++i) {
    if (i > 1) room.Next();
    for (int camera = 0; camera < room.model->ncam; ++camera) {
      const ModelCamera view{camera};
      whole->SetModel(room.model.get());  // forgets
      ASSERT_EQ(Take(*kept, room, view), Take(*whole, room, view))
          << "state " << i << ", camera " << camera;
    }
  }
}

void ExpectSameBytesInAllQualities(int states, uint64_t seed) {
  for (const RenderQuality& quality :
       {kNoEffects, kHardEdges, kSmoothEdges, kSamplesOnly, kMirror}) {
    SCOPED_TRACE(quality.multisamples + 10 * quality.shadows + 100 * quality.reflections);
    ExpectSameBytes(quality, kLamp, 1, states, seed);
    ExpectSameBytes(quality, kCloth, 1, states / 2, seed + 1);
  }
}

TEST(SoftSums, CountTheFlagsOfRectangles) {
  constexpr int kColumns = 7, kRows = 5;
  Rng rng = Rng::Stream(1, "sums");
  std::vector<uint8_t> flags(size_t{kColumns} * kRows);
  for (uint8_t& flag : flags) flag = rng.Uniform(0, 1) < 0.4 ? 1 : 0;
  SoftSums sums;
  sums.Build(kColumns, kRows, [&](size_t i) { return flags[i]; });
  for (int x0 = 0; x0 <= kColumns; ++x0) {
    for (int y0 = 0; y0 <= kRows; ++y0) {
      for (int x1 = x0; x1 <= kColumns; ++x1) {
        for (int y1 = y0; y1 <= kRows; ++y1) {
          int count = 0;
          for (int y = y0; y < y1; ++y) {
            for (int x = x0; x < x1; ++x) count += flags[static_cast<size_t>(kColumns * y + x)];
          }
          ASSERT_EQ(sums.Of(x0, y0, x1, y1), count);
        }
      }
    }
  }
}

TEST(SoftKept, HasTheBytesOfWholePictures) {
  for (uint64_t seed = 1; seed < (LongForm() ? 6 : 2); seed += 2) {
    ExpectSameBytesInAllQualities(LongForm() ? 400 : 12, seed);
  }
}

// Where a pixel of a map is large, a point reads the map far from its own place.
TEST(SoftKept, HasThemWithMapsOfFewPixels) {
  ExpectSameBytes({.shadows = true, .multisamples = 4, .shadow_size = 96}, kWideLamp, 1,
                  LongForm() ? 400 : 8, 5);
}

TEST(SoftKept, HasThemOnSeveralThreads) { ExpectSameBytes(kSmoothEdges, kLamp, 3, 8, 3); }

TEST(SoftKept, HasThemOnEveryInstructionSet) {
  OnEveryInstructionSet([](const std::string& name) {
    SCOPED_TRACE(name);
    ExpectSameBytes(kSmoothEdges, kLamp, 1, 5, 4);
  });
}

}  // namespace
}  // namespace robocell::internal
