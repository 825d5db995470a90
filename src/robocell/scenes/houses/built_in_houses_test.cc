#include "robocell/scenes/houses/built_in_houses.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/scoped_env.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

TEST(BuiltInHouses, AreMadeOnceInTheCache) {
  const TempDir cache;
  const ScopedEnv env("ROBOCELL_CACHE_DIR", cache.path().string());
  const HouseFiles files = BuiltInHouse(2, true);
  const auto made = std::filesystem::last_write_time(files.model);
  for (const auto& file : {files.model, files.map, files.metadata})
    EXPECT_EQ(file.lexically_relative(cache.path()).begin()->string(), "houses");
  EXPECT_EQ(std::filesystem::last_write_time(BuiltInHouse(2, true).model), made);
  EXPECT_NE(BuiltInHouse(2, false).model, files.model);
}

TEST(BuiltInHouses, NameTheVariableOfACacheThatCannotBeWritten) {
  const TempDir folder;
  AtomicWrite(folder / "file", "");
  const ScopedEnv env("ROBOCELL_CACHE_DIR", (folder / "file").string());
  ExpectThrow<IoError>([] { BuiltInHouse(0, true); }, "Set ROBOCELL_CACHE_DIR to a folder");
}

}  // namespace
}  // namespace robocell::internal
