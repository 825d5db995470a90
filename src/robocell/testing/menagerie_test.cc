#include "robocell/testing/menagerie.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "robocell/base/error.h"
#include "robocell/testing/scoped_env.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

class MenagerieTest : public ::testing::Test {
 protected:
  void SetUp() override {
    MissingMenagerie({"any"});  // a shared root, if any, is adopted from here on
    dir_ = fs::path(::testing::TempDir()) /
           ("menagerie_" +
            std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(dir_);
    fs::create_directories(dir_);
  }
  void TearDown() override { fs::remove_all(dir_); }

  void Write(const fs::path& path) const {
    fs::create_directories((dir_ / path).parent_path());
    std::ofstream(dir_ / path) << "<mujoco/>";
  }

  fs::path dir_;
};

TEST_F(MenagerieTest, ARootFromTheEnvironmentIsUsed) {
  Write("arm/arm.xml");
  ScopedEnv root("MENAGERIE_ROOT", dir_.string());
  EXPECT_EQ(MenagerieModel("arm", "arm.xml"), (dir_ / "arm/arm.xml").string());
  EXPECT_EQ(MenagerieModel("arm"), (dir_ / "arm").string());
  EXPECT_EQ(MissingMenagerie({"arm"}), "");
}

TEST_F(MenagerieTest, WithoutARootACompleteCacheIsUsed) {
  Write("models/arm-0123456789abcdef/arm.xml");
  ScopedEnv root("MENAGERIE_ROOT", "");
  ScopedEnv cache("MENAGERIE_CACHE_DIR", dir_.string());
  EXPECT_NE(MissingMenagerie({"arm"}), "") << "half a download is no model";
  Write("models/arm-0123456789abcdef/.complete");
  EXPECT_EQ(MenagerieModel("arm", "arm.xml"),
            (dir_ / "models/arm-0123456789abcdef/arm.xml").string());
  EXPECT_NE(MissingMenagerie({"ar"}), "");
}

TEST_F(MenagerieTest, AMissingModelErrorHasNamePlacesAndCommand) {
  ScopedEnv root("MENAGERIE_ROOT", dir_.string());
  EXPECT_THAT(MissingMenagerie({"arm", "hand"}),
              AllOf(HasSubstr("missing: arm, hand."),
                    HasSubstr((dir_ / "arm").string() + " (MENAGERIE_ROOT)"),
                    HasSubstr("robocell fetch arm hand")));
  EXPECT_THROW(MenagerieModel("arm"), IoError);
}

TEST_F(MenagerieTest, AMissingFileNamesTheFolder) {
  Write("arm/arm.xml");
  ScopedEnv root("MENAGERIE_ROOT", dir_.string());
  try {
    MenagerieModel("arm", "scene.xml");
    FAIL() << "no error";
  } catch (const IoError& error) {
    EXPECT_EQ(std::string(error.what()), "no 'scene.xml' in " + (dir_ / "arm").string());
  }
}

TEST(Skip, OnlyCiTurnsSkipsIntoFailures) {
  ScopedEnv ci("CI", "true");
  EXPECT_TRUE(SkipsAreFailures());
  setenv("CI", "", 1);
  EXPECT_FALSE(SkipsAreFailures());
  setenv("CI", "false", 1);
  EXPECT_FALSE(SkipsAreFailures());
}

}  // namespace
}  // namespace robocell
