#include "robocell/render/gl_painter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "robocell/base/error.h"
#include "robocell/render/gl_context.h"
#include "robocell/render/pixel_buffer.h"
#include "robocell/render/testing/gl_pictures.h"
#include "robocell/testing/skip.h"

namespace robocell::internal {
namespace {

class GlPainters : public testing::Test {
 protected:
  void SetUp() override {
    try {
      context_ = GlContext::Create();
    } catch (const Error& error) {
      SKIP_OR_FAIL(error.what());
    }
  }
  void TearDown() override { GlContext::GiveBack(std::move(context_)); }

  std::unique_ptr<GlContext> context_;
};

TEST_F(GlPainters, GiveTheSameImagesInTwoHalves) {
  const GlContext::Current current(*context_);
  ListedScene scene;
  for (const GlStyle& style : kGlStyles) {
    GlPainter painter(scene.model(), style);
    PixelBuffer pixels(*context_);
    for (const int width : {64, 97, 40}) {
      RawImages at_once, in_halves;
      painter.Paint(scene.Picture(30, width, 51, at_once));
      const GlPicture picture = scene.Picture(30, width, 51, in_halves);
      painter.Begin(picture, pixels);
      GlPainter::Finish(picture, pixels);
      EXPECT_EQ(in_halves, at_once) << width << " pixels wide, " << style.multisamples;
      EXPECT_GT(std::ranges::count_if(at_once.depth, [](float d) { return d > 0; }), 500);
    }
  }
}

TEST_F(GlPainters, SkipImagesThatAreNotWanted) {
  const GlContext::Current current(*context_);
  ListedScene scene;
  GlPainter painter(scene.model(), kGlStyles[1]);
  PixelBuffer pixels(*context_);
  RawImages all, some;
  painter.Paint(scene.Picture(10, 64, 48, all));
  GlPicture picture = scene.Picture(10, 64, 48, some);
  picture.rgb = {};
  picture.codes = {};
  painter.Begin(picture, pixels);
  GlPainter::Finish(picture, pixels);
  EXPECT_EQ(some.depth, all.depth);
  EXPECT_EQ(std::ranges::count(some.rgb, 0), static_cast<long>(some.rgb.size()));
}

TEST_F(GlPainters, LeaveMarkersOutOfDepthAndCodes) {
  const GlContext::Current current(*context_);
  ListedScene scene;
  GlPainter painter(scene.model(), {});
  RawImages plain, marked;
  painter.Paint(scene.Picture(10, 64, 48, plain));
  GlPicture picture = scene.Picture(10, 64, 48, marked);
  mjvGeom& marker = picture.scene->geoms[picture.scene->ngeom++];
  const mjtNum size[3] = {0.3, 0.3, 0.3}, at[3] = {0, 0, 0.5};
  const float yellow[4] = {1, 1, 0, 1};
  mjv_initGeom(&marker, mjGEOM_SPHERE, size, at, nullptr, yellow);
  painter.Paint(picture);
  EXPECT_NE(marked.rgb, plain.rgb);
  EXPECT_EQ(marked.codes, plain.codes);
  EXPECT_EQ(marked.depth, plain.depth);
  EXPECT_EQ(picture.scene->ngeom, picture.exact_geoms + 1);
}

}  // namespace
}  // namespace robocell::internal
