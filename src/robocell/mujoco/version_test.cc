#include "robocell/mujoco/version.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/base/error.h"

namespace robocell {
namespace {

TEST(Version, TheLoadedEngineIsTheOneWeWereBuiltFor) {
  RequireEngineVersion();
  EXPECT_EQ(LoadedEngineVersion(), mj_versionString());
  EXPECT_EQ(CompiledEngineVersion(), LoadedEngineVersion());
}

TEST(Version, RejectsAnotherEngineAndNamesBothVersions) {
  try {
    version_internal::RequireVersions(4000000, 4001002);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_STREQ(
        error.what(),
        "robocell was built for MuJoCo 4.0.0 but MuJoCo 4.1.2 is loaded. Install the right one "
        "(pip install mujoco==4.0.0) or build robocell against the one you have.");
  }
}

}  // namespace
}  // namespace robocell
