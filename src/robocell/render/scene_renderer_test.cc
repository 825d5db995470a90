#include "robocell/render/scene_renderer.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>

#include "robocell/base/error.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/skip.h"

namespace robocell {
namespace {

class FollowingRenderer : public testing::Test {
 protected:
  struct View {
    std::vector<uint8_t> rgb = std::vector<uint8_t>(3 * 64 * 48);
    std::vector<int32_t> ids = std::vector<int32_t>(64 * 48);
    bool operator==(const View&) const = default;
  };

  FollowingRenderer() : scene_(Room()) {}
  void SetUp() override {
    try {
      renderer_ = std::make_unique<SceneRenderer>(scene_);
    } catch (const Error& error) {
      SKIP_OR_FAIL(error.what());
    }
  }
  static Scene Room() {
    SceneSpec spec = EmptyScene();
    spec.cameras.push_back(
        {.name = "front", .pos = Vec3{0, -1, 0.4}, .fovy = 45, .look_at = Vec3{0, 0, 0.1}});
    spec.objects.push_back(BoxObject("first", {0, 0, 0.02}));
    return Scene::Build(spec);
  }
  View Take() {
    View out;
    renderer_->Render({.camera = renderer_->Camera("front"), .width = 64, .height = 48},
                      {.rgb = out.rgb, .segmentation = out.ids});
    return out;
  }
  // Draws with a new renderer.
  View TakeAnew() const {
    View out;
    const auto renderer = MakeRenderer();
    renderer->SetModel(scene_.model());
    const CameraView front = NamedCamera(scene_.model(), "front", "test");
    renderer->Render(scene_.data(), {.camera = front, .width = 64, .height = 48},
                     {.rgb = out.rgb, .segmentation = out.ids});
    return out;
  }
  std::ptrdiff_t PixelsOf(const View& view, const std::string& body) const {
    return std::ranges::count(view.ids, FindId(scene_.model(), mjOBJ_BODY, body));
  }

  Scene scene_;
  std::unique_ptr<SceneRenderer> renderer_;
};

TEST_F(FollowingRenderer, FollowsAddedAndRemovedObjects) {
  const View before = Take();
  EXPECT_EQ(before, TakeAnew());
  SceneObject tower = BoxObject("tower", {0.1, 0, 0.1});
  tower.size = Vec3{0.05, 0.05, 0.1};
  for (int i = 0; i < 3; ++i) {  // the model after a removal has the signature of the first one
    scene_.AddObject(tower);
    const View with = Take();
    EXPECT_EQ(with, TakeAnew());
    EXPECT_GT(PixelsOf(with, "tower"), 50);
    EXPECT_GT(PixelsOf(with, "first"), 3);
    scene_.RemoveObject("tower");
    EXPECT_EQ(Take(), before);
  }
  scene_.RemoveObject("first");
  EXPECT_EQ(Take(), TakeAnew());
}

// The next model has the signature of the drawn one, and may have its address.
TEST_F(FollowingRenderer, APlainRendererRejectsAFreedModel) {
  const auto renderer = MakeRenderer();
  renderer->SetModel(scene_.model());
  const uint64_t signature = scene_.model()->signature;
  scene_.AddObject(BoxObject("second", {0.1, 0, 0.02}));
  scene_.RemoveObject("second");
  ASSERT_EQ(scene_.model()->signature, signature);
  std::vector<uint8_t> rgb(3 * 64 * 48);
  ExpectThrow<ArgumentError>(
      [&] { renderer->Render(scene_.data(), {.width = 64, .height = 48}, {.rgb = rgb}); },
      "renderer: the model that it was given was freed; call SetModel after a scene was built "
      "again, or draw with a SceneRenderer");
}

TEST_F(FollowingRenderer, UsesTheCurrentCamerasOfTheScene) {
  ExpectThrow<NotFoundError>([&] { renderer_->Camera("frnt"); },
                             "scene 'test': no camera 'frnt'. Its cameras: front. Did you mean "
                             "'front'?");
  EXPECT_EQ(renderer_->scene(), scene_);
  EXPECT_EQ(renderer_->description(), MakeRenderer()->description());
}

TEST_F(FollowingRenderer, RejectsAClosedScene) {
  Take();
  scene_.Close();
  const std::string closed = "scene 'test' is closed";
  ExpectThrow<ClosedError>([&] { renderer_->Camera("front"); }, closed);
  std::vector<uint8_t> rgb(3 * 64 * 48);
  ExpectThrow<ClosedError>([&] { renderer_->Render({.width = 64, .height = 48}, {.rgb = rgb}); },
                           closed);
}

}  // namespace
}  // namespace robocell
