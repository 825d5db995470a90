#include "robocell/task/furniture.h"

#include <gtest/gtest.h>

#include <cmath>

#include "robocell/scene/testing/scenes.h"

namespace robocell {
namespace {

TEST(Furniture, StandsOnTheTableWithItsFrontOverAnEdge) {
  EXPECT_TRUE(internal::IsFurniture("chest"));
  EXPECT_TRUE(internal::IsFurniture("button_panel"));
  EXPECT_FALSE(internal::IsFurniture("mug"));
  EXPECT_FALSE(internal::IsFurniture("tray"));
  SceneSpec spec = EmptyScene();
  spec.base = "tabletop";
  const SceneAnnotations annotations = DeriveAnnotations(spec);
  for (uint64_t seed = 0; seed < 10; ++seed) {
    Rng rng = Rng::Stream(seed, "furniture");
    const SceneObject chest = internal::PutFurniture(spec, annotations, "unit", "chest", rng);
    const Pose pose = chest.pose();
    EXPECT_EQ(chest.fixed, true);
    EXPECT_NEAR(pose.translation().z(), 0.45, 0.001);
    // The table is longer along y: its longer edges are at the ends of x.
    EXPECT_GT(std::abs(pose.rotation()(0, 0)), 0.9);
  }
}

}  // namespace
}  // namespace robocell
