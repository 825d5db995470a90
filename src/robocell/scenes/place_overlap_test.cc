#include "robocell/scenes/place_overlap.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>

#include "robocell/base/rng.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/testing/scenes.h"

namespace robocell {
namespace {

// The engine's contacts of the object that was really put there are the oracle.
TEST(PlaceOverlap, AgreesWithTheContactsOfTheEngine) {
  SceneSpec spec = EmptyScene();
  spec.objects.push_back(BoxObject("thing", {0, 0, 1}));
  SceneObject block = BoxObject("block", {0.1, 0, 0.02});
  block.fixed = true;
  spec.objects.push_back(block);
  spec.objects.push_back(
      {.name = "dish", .mjcf_path = "tray", .pos = Vec3{-0.2, 0, 0}, .fixed = true});
  Scene scene = Scene::Build(spec);
  scene.Reset();
  scene.Forward();
  const int body = FindId(scene.model(), mjOBJ_BODY, "thing");
  internal::PlaceOverlap overlap(scene, body);
  Rng rng = Rng::Stream(0, "places");
  int free = 0;
  for (int i = 0; i < 400; ++i) {
    const Pose pose =
        Pose::FromRpy({rng.Uniform(-0.4, 0.2), rng.Uniform(-0.2, 0.2), rng.Uniform(0.01, 0.1)},
                      {rng.Uniform(-3, 3), rng.Uniform(-3, 3), rng.Uniform(-3, 3)});
    scene.SetBodyPose("thing", pose);
    scene.Forward();
    double deepest = 0;
    for (int c = 0; c < scene.data()->ncon; ++c) {
      const mjContact& contact = scene.data()->contact[c];
      const bool is_own = scene.model()->geom_bodyid[contact.geom[0]] == body ||
                          scene.model()->geom_bodyid[contact.geom[1]] == body;
      if (is_own) deepest = std::min(deepest, contact.dist);
    }
    // Two ways to measure a depth differ somewhat: the doubtful ones say nothing.
    const double most = internal::PlaceOverlap::kMostDeep;
    if (std::abs(deepest + most) < 0.3 * most) continue;
    EXPECT_EQ(overlap.IsFree(pose), deepest > -most) << pose << " deep " << deepest;
    free += deepest > -most;
  }
  EXPECT_GT(free, 50);
  EXPECT_LT(free, 350);
}

}  // namespace
}  // namespace robocell
