#include "robocell/render/pixel_buffer.h"

#include <gtest/gtest.h>

#include <memory>

#include "robocell/base/error.h"
#include "robocell/render/gl_context.h"
#include "robocell/render/gl_painter.h"
#include "robocell/render/testing/gl_pictures.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/skip.h"

namespace robocell::internal {
namespace {

TEST(PixelBuffers, KeepAnImageWhileOthersAreDrawn) {
  std::unique_ptr<GlContext> context;
  try {
    context = GlContext::Create();
  } catch (const Error& error) {
    SKIP_OR_FAIL(error.what());
  }
  {
    const GlContext::Current current(*context);
    ListedScene scene;
    GlPainter painter(scene.model(), {});
    RawImages expected[2], images[2];
    for (int i = 0; i < 2; ++i) painter.Paint(scene.Picture(40 * i, 64, 48, expected[i]));
    PixelBuffer buffers[2] = {PixelBuffer(*context), PixelBuffer(*context)};
    GlPicture pictures[2];
    for (int i = 0; i < 2; ++i) {
      pictures[i] = scene.Picture(40 * i, 64, 48, images[i]);
      painter.Begin(pictures[i], buffers[i]);
    }
    for (int i = 0; i < 2; ++i) GlPainter::Finish(pictures[i], buffers[i]);
    EXPECT_EQ(images[0], expected[0]);
    EXPECT_EQ(images[1], expected[1]);
    EXPECT_NE(images[0], images[1]);
  }
  GlContext::GiveBack(std::move(context));
}

class OldDriver final : public GlContext {
 public:
  OldDriver() { description_ = "egl: an old driver"; }
  GlBackend backend() const override { return GlBackend::kEgl; }
  void* Function(const char*) const override { return nullptr; }

 private:
  void Enter(Saved&) override {}
  void Leave(Saved&) noexcept override {}
};

TEST(PixelBuffers, NameTheFunctionThatADriverLacks) {
  const OldDriver driver;
  ExpectThrow<Error>([&] { PixelBuffer buffer(driver); }, "egl: an old driver has no glGenBuffers");
}

}  // namespace
}  // namespace robocell::internal
