#include "robocell/viewer/window.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/testing/scoped_env.h"
#include "robocell/viewer/testing/users.h"

namespace robocell {
namespace {

TEST_F(Viewers, WithoutADisplayTheErrorNamesWhatToDo) {
  const ScopedEnv no_display("DISPLAY", ":nowhere");
  const ScopedEnv no_wayland("WAYLAND_DISPLAY", "");
  try {
    Viewer::Open(scene_);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("viewer: no window"));
    EXPECT_THAT(error.what(), ::testing::HasSubstr("apt install"));
  }
}

}  // namespace
}  // namespace robocell
