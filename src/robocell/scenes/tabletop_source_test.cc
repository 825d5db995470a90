#include "robocell/scenes/built_in_sources.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/testing/pick_scene.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;

TEST(TabletopSource, IsATabletopByDefault) {
  const RunConfig run = ExampleRun("demo.yaml");
  const SceneSpec spec = MakeBaseScene(run, 0);
  EXPECT_EQ(spec.name, "demo");
  EXPECT_EQ(spec.base, "tabletop");
  EXPECT_EQ(spec.timestep, 0.002);
  EXPECT_TRUE(spec.robots.empty());
  EXPECT_EQ(MakeSceneSource(run)->size(), std::nullopt);
  EXPECT_THAT(SceneIndices(run), ElementsAre(0));
}

}  // namespace
}  // namespace robocell
