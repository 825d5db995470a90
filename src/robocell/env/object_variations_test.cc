#include "robocell/env/object_variations.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/base/error.h"
#include "robocell/env/env_scene.h"
#include "robocell/env/testing/envs.h"
#include "robocell/mujoco/names.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

struct VariedCube {
  EnvConfig config = Rc7WithCube();
  Scene scene;
  ObjectVariations variations;

  explicit VariedCube(const ObjectVariation& range)
      : config([&] {
          EnvConfig with = Rc7WithCube();
          with.variations["cube"] = range;
          return with;
        }()),
        scene(Scene::FromCompiled(CompileEnvScene(config))),
        variations(config, scene) {}
  double mass() const { return scene.model()->body_mass[Body()]; }
  int Body() const { return FindId(scene.model(), mjOBJ_BODY, "cube"); }
};

TEST(ObjectVariations, MassesAreWithinTheirRangeAndInertiasFollow) {
  VariedCube varied({.mass = {0.5, 2}});
  const double mass = varied.mass();
  const double inertia = varied.scene.model()->body_inertia[3 * varied.Body()];
  double least = 1e9, most = 0;
  for (int k = 0; k < 100; ++k) {
    Rng rng = Rng::Stream(1, "variation", k);
    varied.variations.Draw(rng);
    const double factor = varied.mass() / mass;
    EXPECT_GE(factor, 0.5 - 1e-9);
    EXPECT_LE(factor, 2 + 1e-9);
    EXPECT_NEAR(varied.scene.model()->body_inertia[3 * varied.Body()], factor * inertia, 1e-12);
    least = std::min(least, factor);
    most = std::max(most, factor);
  }
  EXPECT_LT(least, 0.6);
  EXPECT_GT(most, 1.8);
}

TEST(ObjectVariations, TheSameNumbersGiveTheSameObjectAgain) {
  VariedCube varied({.mass = {0.5, 2}, .friction = {0.5, 1}, .colour = 0.2});
  Rng rng = Rng::Stream(1, "variation");
  varied.variations.Draw(rng);
  const std::vector<double> drawn = varied.variations.drawn();
  ASSERT_EQ(drawn.size(), 5u);
  const double mass = varied.mass();
  varied.variations.Draw(rng);
  EXPECT_NE(varied.mass(), mass);
  varied.variations.Apply(drawn);
  EXPECT_EQ(varied.mass(), mass);
  ExpectThrow<ArgumentError>([&] { varied.variations.Apply(std::vector<double>(4)); }, "got 4");
}

}  // namespace
}  // namespace robocell::internal
