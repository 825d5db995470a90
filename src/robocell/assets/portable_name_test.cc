#include "robocell/assets/portable_name.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "robocell/assets/resolve.h"
#include "robocell/base/files.h"
#include "robocell/testing/menagerie.h"
#include "robocell/testing/scoped_env.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::assets {
namespace {

TEST(PortableName, OfEveryBuiltinModelIsItsName) {
  for (const std::string& name : BuiltinModels()) EXPECT_EQ(PortableName(Resolve(name)), name);
}

TEST(PortableName, OfAModelOfTheMenagerieSaysSo) {
  REQUIRE_MENAGERIE("ufactory_xarm7");
  const std::string name = "menagerie:ufactory_xarm7/xarm7.xml";
  EXPECT_EQ(PortableName(Resolve(name)), name);
}

TEST(PortableName, IsNoneForAFileOfOnesOwn) {
  TempDir temp;
  AtomicWrite(temp / "arm.xml", "<mujoco/>");
  EXPECT_EQ(PortableName(temp / "arm.xml"), std::nullopt);
  std::filesystem::create_directory(temp / "rc7");
  AtomicWrite(temp / "rc7/rc7.xml", "<mujoco/>");  // called like a built-in one
  EXPECT_EQ(PortableName(temp / "rc7/rc7.xml"), std::nullopt);
}

TEST(PortableName, IsNoneForAFileThatTakesTheModelsPlaceHere) {
  const TempDir temp;
  const std::string mine = temp / "table.xml";
  AtomicWrite(mine, "<mujoco/>");
  const std::string original = Resolve("table");
  const ScopedEnv env("ROBOCELL_OVERRIDE_TABLE", mine);
  EXPECT_EQ(PortableName(mine), std::nullopt);
  EXPECT_EQ(PortableName(original), std::nullopt) << "the name means another file here";
}

}  // namespace
}  // namespace robocell::assets
