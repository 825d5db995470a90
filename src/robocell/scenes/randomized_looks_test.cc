// What a RandomizedModel changes of the look, in pictures of the software renderer.
#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "robocell/render/renderer.h"
#include "robocell/scenes/randomized_model.h"

namespace robocell::internal {
namespace {

Scene LitCube() {
  SceneSpec spec{.timestep = 0.002, .add_floor = true, .add_skybox = true};
  spec.objects.push_back({.name = "cube",
                          .shape = Shape::kBox,
                          .size = Vec3{0.1, 0.1, 0.1},
                          .rgba = Vec4{0.8, 0.4, 0.2, 1},
                          .mass = 0.5,
                          .friction = Vec3{1, 0.005, 0.0001},
                          .pos = Vec3{0, 0, 0.1}});
  AddStudio(spec);
  return Scene::Build(spec);
}

class Camera {
 public:
  Camera() : renderer_(MakeRenderer({.backend = "soft", .quality = {.shadows = true}})) {}
  std::vector<uint8_t> Picture(const Scene& scene) {
    if (!is_set_) renderer_->SetModel(scene.model());
    is_set_ = true;
    std::vector<uint8_t> rgb(3 * 48 * 32);
    renderer_->Render(scene.data(), {.camera = view_, .width = 48, .height = 32}, {.rgb = rgb});
    return rgb;
  }

 private:
  std::unique_ptr<Renderer> renderer_;
  OrbitCamera view_{.lookat = {0, 0, 0.1}, .distance = 0.9, .elevation = -15};
  bool is_set_ = false;
};

TEST(RandomizedLooks, PicturesShowEachOfThemAndAreTheSameAgainAfterwards) {
  Scene scene = LitCube();
  Camera camera;
  const std::vector<uint8_t> before = camera.Picture(scene);
  RandomizedModel model(scene);
  for (const RandomizedValues& values :
       {RandomizedValues{{"cube/texture", {.numbers = {}, .word = "dots"}}},
        RandomizedValues{{"floor/texture", {.numbers = {}, .word = "bricks"}}},
        RandomizedValues{{"cube/colour", {.numbers = {0, 0, 1}}}},
        RandomizedValues{{"sky/horizon", {.numbers = {1, 0, 0}}}},
        RandomizedValues{{"light/0/azimuth", {.numbers = {10}}}},
        RandomizedValues{{"light/number", {.numbers = {3}}}},
        RandomizedValues{{"light/ambient", {.numbers = {0.9}}}}}) {
    model.Apply(values);
    EXPECT_NE(camera.Picture(scene), before) << values.keys().front();
    model.Restore();
    EXPECT_EQ(camera.Picture(scene), before) << values.keys().front();
  }
}

TEST(RandomizedLooks, ASeedChoosesColoursAndPattern) {
  Scene scene = LitCube();
  Camera camera;
  RandomizedModel model(scene);
  std::vector<std::vector<uint8_t>> pictures;
  for (const double seed : {1.0, 2.0, 1.0}) {
    model.Apply({{"cube/texture", {.numbers = {}, .word = "marble"}},
                 {"cube/texture_seed", {.numbers = {seed}}}});
    pictures.push_back(camera.Picture(scene));
  }
  EXPECT_NE(pictures[0], pictures[1]);
  EXPECT_EQ(pictures[0], pictures[2]);
}

}  // namespace
}  // namespace robocell::internal
