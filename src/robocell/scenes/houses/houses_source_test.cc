#include <gtest/gtest.h>

#include <gmock/gmock.h>

#include "robocell/base/error.h"
#include "robocell/scenes/houses/houses_config.h"
#include "robocell/scenes/scene_source.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/pick_scene.h"
#include "robocell/testing/scoped_env.h"
#include "robocell/testing/source_dir.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;

TEST(HousesSource, RunsTakeTheHousesThatCanBeUsed) {
  const TempDir cache;
  const ScopedEnv env("ROBOCELL_CACHE_DIR", cache.path().string());
  RunConfig run = ExampleRun("demo.yaml");
  run.scenes = HousesScenes{.root = SourceDir() + "/tests/houses/scenes/procthor-10k-train"};
  EXPECT_THAT(SceneIndices(run), ElementsAre(0, 3));
  run.scenes.houses.values = {1, 2};
  ExpectThrow<SpecError>([&] { SceneIndices(run); },
                         "2 of 2 scenes are left out: 1, 2 (no such house)");
  run.scenes.houses.values = {3, 1};
  EXPECT_THAT(SceneIndices(run), ElementsAre(3));
  ExpectThrow<NotFoundError>([&] { MakeBaseScene(run, 1); }, "no house 1");
  EXPECT_EQ(MakeSceneSource(run)->Annotations(3).supports.size(), 1U);
}

}  // namespace
}  // namespace robocell
