#include "robocell/scenes/houses/prepared_house.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "robocell/scene/scene.h"
#include "robocell/testing/scoped_env.h"
#include "robocell/testing/source_dir.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(PreparedHouse, BalancesInertiasInACopy) {
  const TempDir cache;
  const ScopedEnv env("ROBOCELL_CACHE_DIR", cache.path().string());
  const HouseFolder folder =
      HouseFolder::Find({.root = SourceDir() + "/tests/houses/scenes/procthor-10k-train"}, "");
  const PreparedHouse whole = PrepareHouse(folder.houses().at(0), folder);
  EXPECT_EQ(whole.why_not, "");
  EXPECT_EQ(whole.model, folder.houses().at(0).model);
  const PreparedHouse mended = PrepareHouse(folder.houses().at(3), folder);
  EXPECT_EQ(mended.why_not, "");
  EXPECT_THAT(mended.notes, ElementsAre(HasSubstr("2 bodies were balanced: Statue|0|2, Cup|0|3")));
  EXPECT_THAT(mended.model.string(), HasSubstr(cache.path().string()));
  Scene::Build({.base = mended.model.string(), .timestep = 0.002});
}

}  // namespace
}  // namespace robocell::internal
