#include "robocell/render/gl_canvas.h"

#include <gtest/gtest.h>

#include <memory>

#include "robocell/base/error.h"
#include "robocell/render/testing/gl_pictures.h"
#include "robocell/testing/skip.h"

namespace robocell::internal {
namespace {

TEST(OwnCanvases, DrawTheSameAfterAnotherModel) {
  std::unique_ptr<OwnCanvas> canvas;
  try {
    canvas = std::make_unique<OwnCanvas>(GlBackend::kAuto, kGlStyles[1]);
  } catch (const Error& error) {
    SKIP_OR_FAIL(error.what());
  }
  ListedScene scene;
  RawImages first, again;
  canvas->SetModel(scene.model());
  canvas->Paint(scene.Picture(20, 64, 48, first));
  {
    ListedScene other("<mujoco><worldbody><geom size='.3'/></worldbody></mujoco>");
    RawImages elsewhere;
    canvas->SetModel(other.model());
    canvas->Paint(other.Picture(20, 64, 48, elsewhere));
    EXPECT_NE(elsewhere, first);
  }
  canvas->SetModel(scene.model());
  canvas->Paint(scene.Picture(20, 64, 48, again));
  EXPECT_EQ(again, first);
}

}  // namespace
}  // namespace robocell::internal
