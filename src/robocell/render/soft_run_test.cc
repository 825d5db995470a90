// Tests runs of blocks that show one flat face: an image is drawn once whole and once in strips that
// are narrower than a run, so that each of their pixels is coloured by itself.
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "robocell/mujoco/clip_planes.h"
#include "robocell/mujoco/compile.h"
#include "robocell/render/camera_model.h"
#include "robocell/render/renderer.h"

namespace robocell {
namespace {

constexpr int kWidth = 144, kHeight = 96, kStrip = 12, kStrips = kWidth / kStrip;

std::string Camera(const std::string& name, int width, int to_right) {
  return "<camera name='" + name +
         "' pos='0.2 -1.1 0.9' xyaxes='1 0.1 0 -0.06 0.6 0.8' resolution='" +
         std::to_string(width) + " " + std::to_string(kHeight) + "' sensorsize='" +
         std::to_string(0.001 * width) + " " + std::to_string(0.001 * kHeight) +
         "' focalpixel='110 110' principalpixel='" + std::to_string(to_right) + " 0'/>";
}

// A floor, a shiny table, and something that casts shadows on both. `floor`: attributes.
ModelPtr Room(const std::string& floor) {
  std::string cameras = Camera("whole", kWidth, 0);
  for (int i = 0; i < kStrips; ++i) {
    cameras += Camera("strip" + std::to_string(i), kStrip, kStrip * i - (kWidth - kStrip) / 2);
  }
  const SpecPtr spec = ParseXmlString(R"(
    <mujoco>
      <asset>
        <texture name="t" type="2d" builtin="checker" rgb1=".2 .3 .4" rgb2=".7 .6 .5" width="128"
                 height="128" mark="random" random="0.002" markrgb="1 1 1"/>
        <material name="tiles" texture="t" texuniform="true" texrepeat="2 2" specular="0"/>
        <material name="shiny" specular=".5" shininess=".2"/>
      </asset>
      <worldbody>
        <light directional="true" dir=".4 .3 -1" castshadow="true" diffuse=".6 .6 .6"/>
        <geom type="box" size=".3 .2 .15" pos=".3 .2 .15" material="shiny" rgba=".8 .5 .2 1"/>
        <geom type="box" size=".05 .2 .05" pos="-.1 .1 .6" euler="20 30 40"/>
        <geom type="plane" size="3 3 .1" euler="0 0 25" )" +
                                      floor + "/>" + cameras + "</worldbody></mujoco>");
  internal::SetClipPlanes(spec.get(), 1, 0.01, 30);
  return Compile(spec.get());
}

// Returns how many pixels of the whole image are more than `steps` of 255 from those of the strips.
int Different(const mjModel* model, int steps, int shadow_size) {
  const DataPtr data = MakeData(model);
  mj_forward(model, data.get());
  const auto renderer =
      MakeRenderer({.backend = "soft", .quality = {.shadows = true, .shadow_size = shadow_size}});
  renderer->SetModel(model);
  const auto draw = [&](const std::string& camera, int width, std::vector<uint8_t>* rgb,
                        std::vector<float>* depth) {
    rgb->resize(size_t{3} * static_cast<size_t>(width) * kHeight);
    depth->resize(static_cast<size_t>(width) * kHeight);
    renderer->Render(
        data.get(),
        {.camera = NamedCamera(model, camera, "test"), .width = width, .height = kHeight},
        {.rgb = *rgb, .depth = *depth});
  };
  std::vector<uint8_t> whole, strip;
  std::vector<float> whole_depth, depth;
  draw("whole", kWidth, &whole, &whole_depth);
  int same = 0, different = 0;
  for (int i = 0; i < kStrips; ++i) {
    draw("strip" + std::to_string(i), kStrip, &strip, &depth);
    for (int k = 0; k < kStrip * kHeight; ++k) {
      const int at = k / kStrip * kWidth + kStrip * i + k % kStrip;
      if (std::abs(whole_depth[at] - depth[k]) > 1e-4f) continue;  // edges are rounded
      ++same;
      int apart = 0;
      for (int c = 0; c < 3; ++c)
        apart = std::max(apart, std::abs(whole[3 * at + c] - strip[3 * k + c]));
      different += apart > steps;
    }
  }
  EXPECT_GT(same, kWidth * kHeight * 98 / 100) << "the strips are parts of the image";
  EXPECT_GT(*std::ranges::max_element(whole), *std::ranges::min_element(whole) + 60);
  return different;
}

TEST(SoftRuns, HaveTheLightAndShadowsOfTheirPixels) {
  const ModelPtr model = Room("rgba='.3 .5 .6 1'");
  for (const int shadow_size : {48, 256, 1024})
    EXPECT_LT(Different(model.get(), 1, shadow_size), kWidth * kHeight / 1000) << shadow_size;
}

// A block has one level of the texture.
TEST(SoftRuns, HaveNearlyTheTextureOfTheirPixels) {
  const ModelPtr model = Room("material='tiles'");
  EXPECT_EQ(Different(model.get(), 10, 256), 0);
  EXPECT_LT(Different(model.get(), 1, 256), kWidth * kHeight / 10);
}

}  // namespace
}  // namespace robocell
