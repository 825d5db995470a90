#include "robocell/viewer/window.h"

#include <gtest/gtest.h>

#include <cstdint>

#include "robocell/viewer/testing/users.h"

namespace robocell {
namespace {

TEST_F(Viewers, DrawsTheSceneBetweenItsPanels) {
  ViewerOptions options = kInMemory;
  options.width = 1000;
  Viewer viewer = Viewer::Open(scene_, options);
  viewer.view().SetFreeCamera(0.3, 90, -89, {0.6, 0.2, 0.02});
  int width = 0, height = 0;
  const auto pixels = viewer.Pixels(&width, &height);
  ASSERT_EQ(width, 1000);
  ASSERT_EQ(pixels.size(), 3u * 1000 * 480);
  const uint8_t* middle = pixels.data() + 3 * (240 * 1000 + 530);
  EXPECT_GT(middle[0], 2 * middle[2]) << "the orange cube";
}

}  // namespace
}  // namespace robocell
