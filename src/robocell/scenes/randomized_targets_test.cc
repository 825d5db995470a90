#include "robocell/scenes/randomized_targets.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(RandomizedTargets, PatternsMeanObjectsBodiesAndGeomsOfTheWorld) {
  SceneSpec spec{.base = "tabletop", .timestep = 0.002, .add_floor = true, .add_skybox = true};
  spec.objects.push_back({.name = "cup", .mjcf_path = "mug", .pos = Vec3{0, 0, 1}});
  spec.objects.push_back({.name = "box", .mjcf_path = "cupboard", .pos = Vec3{1, 0, 0}});
  RandomizedTargets targets(Scene::Build(spec));
  EXPECT_THAT(targets.Matching("objects"), ElementsAre("cup", "box"));
  EXPECT_THAT(targets.Matching("c?p"), ElementsAre("cup"));
  EXPECT_THAT(targets.Matching("tab*"), ElementsAre("table"));
  EXPECT_THAT(targets.Matching("floor"), ElementsAre("floor"));
  EXPECT_THAT(targets.Matching("robots"), IsEmpty());
  EXPECT_THAT(targets.Matching("box_door"), ElementsAre("box_door")) << "any body by its own name";
  EXPECT_EQ(targets.At("box", "").dofs.size(), 1u);
  EXPECT_TRUE(targets.At("floor", "").bodies.empty());
  EXPECT_FALSE(targets.Has("cups"));
  EXPECT_NO_THROW(targets.RequireMatch("mug_*", {"mug_1"}, "run 'a'"));
  ExpectThrow<NotFoundError>([&] { targets.RequireMatch("cupp", {"mug"}, "run 'a'"); },
                             "Did you mean 'cup'?");
}

}  // namespace
}  // namespace robocell::internal
