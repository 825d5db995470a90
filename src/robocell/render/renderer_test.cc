// Tests the guarantees of every back end of renderer.h.
#include "robocell/render/renderer.h"

#include <dlfcn.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <thread>

#include "robocell/base/error.h"
#include "robocell/mujoco/clip_planes.h"
#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/step.h"
#include "robocell/testing/count_allocations.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/skip.h"

namespace robocell {
namespace {

constexpr int kW = 160, kH = 120;

constexpr char kSpheres[] = R"(<mujoco>
  <asset>
    <texture name="sky" type="skybox" builtin="gradient" rgb1=".3 .5 .7" rgb2="0 0 0" width="64" height="384"/>
    <texture name="grid" type="2d" builtin="checker" rgb1=".2 .3 .4" rgb2=".1 .2 .3" width="64" height="64"/>
    <material name="grid" texture="grid" texrepeat="4 4" reflectance=".4"/>
  </asset>
  <worldbody>
    <light pos="0 0 3" dir="0 .3 -1" castshadow="true"/>
    <geom type="plane" size="0 0 .1" material="grid"/>
    <body name="ball" pos="0 0 1"><freejoint/><geom size=".2" rgba="1 0 0 1"/><site name="mark" size=".3" rgba="0 1 0 1"/></body>
    <body name="box" pos=".6 0 .3"><geom type="box" size=".1 .2 .3" rgba="0 0 1 1"/><geom size=".3" group="3"/></body>
    <camera name="front" pos="0 -2.5 .8" xyaxes="1 0 0 0 .1 1"/>
  </worldbody></mujoco>)";

struct Images {
  std::vector<uint8_t> rgb;
  std::vector<float> depth;
  std::vector<int32_t> ids;
  CameraModel camera;
  bool operator==(const Images& other) const {
    return rgb == other.rgb && depth == other.depth && ids == other.ids;
  }
};

class Rendering : public testing::TestWithParam<std::string> {
 protected:
  Rendering() {
    SpecPtr spec = ParseXmlString(kSpheres);
    internal::SetClipPlanes(spec.get(), 2, 0.01, 50);
    model_ = Compile(spec.get());
    data_ = MakeData(model_.get());
  }
  static void TearDownTestSuite() { shared_.clear(); }
  void SetUp() override {
    try {
      auto& shared = shared_[GetParam()];
      if (!shared) shared = MakeRenderer({.backend = GetParam()});  // OpenGL's takes 0.2 s
      renderer_ = shared.get();
      renderer_->SetModel(model_.get());
    } catch (const Error& error) {
      SKIP_OR_FAIL(error.what());
    }
  }
  std::unique_ptr<Renderer> Make(const RendererOptions& options) {
    RendererOptions of_this = options;
    of_this.backend = GetParam();
    auto renderer = MakeRenderer(of_this);
    renderer->SetModel(model_.get());
    return renderer;
  }
  Images Take(Renderer& renderer, int width = kW, int height = kH) {
    Images out{std::vector<uint8_t>(3 * width * height),
               std::vector<float>(width * height),
               std::vector<int32_t>(width * height),
               {}};
    out.camera =
        renderer.Render(data_.get(), {.camera = ModelCamera{0}, .width = width, .height = height},
                        {.rgb = out.rgb, .depth = out.depth, .segmentation = out.ids});
    return out;
  }
  int Pixel(const CameraModel& camera, const Eigen::Vector3d& point) {
    const Eigen::Vector2d uv = camera.Project(point);
    EXPECT_TRUE(camera.Contains(point));
    return static_cast<int>(std::lround(uv.y())) * camera.width +
           static_cast<int>(std::lround(uv.x()));
  }

  ModelPtr model_;
  DataPtr data_;
  Renderer* renderer_ = nullptr;
  static inline std::map<std::string, std::unique_ptr<Renderer>> shared_;
};

TEST_P(Rendering, ShowsColourDepthAndBodiesOfTheSameScene) {
  const Images images = Take(*renderer_);
  const int ball = Pixel(images.camera, {0, 0, 1}), floor = (kH - 1) * kW, sky = 0;
  EXPECT_EQ(images.ids[ball], mj_name2id(model_.get(), mjOBJ_BODY, "ball"));
  EXPECT_NEAR(images.depth[ball], images.camera.Depth({0, -0.2, 1}), 0.01);
  EXPECT_GT(images.rgb[3 * ball], 2 * images.rgb[3 * ball + 1]);  // red
  EXPECT_EQ(images.ids[floor], 0);
  EXPECT_GT(images.depth[floor], 0);
  EXPECT_EQ(images.ids[sky], -1);
  EXPECT_EQ(images.depth[sky], 0);  // although the sky is drawn
  EXPECT_GT(images.rgb[2], 20);
}

TEST_P(Rendering, DoesNotDependOnOtherRenders) {
  const Images first = Take(*renderer_);
  EXPECT_EQ(Take(*renderer_), first);
  Take(*renderer_, 333, 201);  // a larger buffer, which stays
  data_->qpos[0] = 0.3;
  Take(*renderer_);
  data_->qpos[0] = 0;
  EXPECT_EQ(Take(*renderer_), first);
  EXPECT_EQ(Take(*Make({})), first);
  Images elsewhere;
  std::thread([&] { elsewhere = Take(*renderer_); }).join();
  EXPECT_EQ(elsewhere, first);
}

TEST_P(Rendering, IsTheSameInAUsedContext) {
  const Images first = Take(*renderer_);
  const RendererOptions fine{
      .quality = {.shadows = true, .reflections = true, .multisamples = 4, .shadow_size = 512},
      .visibility = {.sites = true}};
  for (int i = 0; i < 3; ++i) {  // contexts are kept when their renderers end, see gl_context.h
    Take(*Make(fine), 64, 48);
    EXPECT_EQ(Take(*Make({})), first);
  }
}

TEST_P(Rendering, ImagesShowTheCurrentState) {
  data_->qvel[2] = 5;
  ASSERT_TRUE(Step(model_.get(), data_.get(), 50).ok());
  EXPECT_NE(data_->xpos[3 + 2], data_->qpos[2]);  // the engine's poses are behind
  const Images after_step = Take(*renderer_);
  Forward(model_.get(), data_.get());
  EXPECT_EQ(Take(*renderer_), after_step);
  EXPECT_EQ(after_step.ids[Pixel(after_step.camera, {0, 0, data_->qpos[2]})], 1);
}

TEST_P(Rendering, ReadsTheDataOnly) {
  DataPtr before = CopyData(model_.get(), data_.get());
  Take(*renderer_);
  std::vector<double> a(mj_stateSize(model_.get(), mjSTATE_INTEGRATION)), b(a.size());
  mj_getState(model_.get(), data_.get(), a.data(), mjSTATE_INTEGRATION);
  mj_getState(model_.get(), before.get(), b.data(), mjSTATE_INTEGRATION);
  EXPECT_EQ(a, b);
  EXPECT_TRUE(std::equal(data_->xpos, data_->xpos + 3 * model_->nbody, before->xpos));
}

TEST_P(Rendering, HidesCollisionGeomsAndSitesByDefault) {
  const std::vector<int32_t> ids = Take(*renderer_).ids;
  RendererOptions options;
  options.visibility.sites = true;
  options.visibility.geom_groups[3] = true;
  const std::vector<int32_t> all = Take(*Make(options)).ids;
  EXPECT_GT(std::count(all.begin(), all.end(), 1), 1.5 * std::count(ids.begin(), ids.end(), 1));
  EXPECT_GT(std::count(all.begin(), all.end(), 2), 1.2 * std::count(ids.begin(), ids.end(), 2));
}

TEST_P(Rendering, QualityChangesColourOnly) {
  const Images plain = Take(*renderer_);
  RendererOptions options;
  options.quality = {.shadows = true, .reflections = true, .multisamples = 4, .shadow_size = 512};
  const auto fine = Make(options);
  const Images images = Take(*fine);
  EXPECT_NE(images.rgb, plain.rgb);
  EXPECT_EQ(images.ids, plain.ids);
  EXPECT_EQ(images.depth, plain.depth);
  EXPECT_EQ(fine->quality().multisamples, 4);
  EXPECT_FALSE(renderer_->quality().shadows);
}

TEST_P(Rendering, AnEmptyFloorHasNoShadows) {
  SpecPtr spec = ParseXmlString(R"(<mujoco>
    <worldbody>
      <light type="directional" pos="0.8 0.9 2.5" dir="-0.35 -0.4 -1"/>
      <geom type="plane" size="0 0 .1"/>
      <camera name="front" pos="2 -2 1.2" xyaxes="1 1 0 -.2 .2 1"/>
    </worldbody></mujoco>)");
  internal::SetClipPlanes(spec.get(), 1.4, 0.01, 100);
  model_ = Compile(spec.get());
  data_ = MakeData(model_.get());
  renderer_->SetModel(model_.get());
  const Images plain = Take(*renderer_);
  const Images shaded = Take(*Make({.quality = {.shadows = true}}));
  int darker = 0;
  for (size_t i = 0; i < plain.rgb.size(); ++i) darker += shaded.rgb[i] + 2 < plain.rgb[i];
  EXPECT_EQ(darker, 0);
}

TEST_P(Rendering, WithoutVisibleGeomsTheImageIsEmpty) {
  const Visibility nothing{.geom_groups = {}, .sites = false, .skybox = false};
  const Images images = Take(*Make({.visibility = nothing}));
  EXPECT_THAT(images.rgb, testing::Each(images.rgb.front()));
  EXPECT_THAT(images.depth, testing::Each(0));
  EXPECT_THAT(images.ids, testing::Each(-1));
  EXPECT_EQ(images.camera.width, kW);
}

TEST_P(Rendering, ColoursAreReadFromTheModelEachTime) {
  const Images red = Take(*renderer_);
  std::swap(model_->geom_rgba[4 * 1 + 0], model_->geom_rgba[4 * 1 + 1]);
  const Images green = Take(*renderer_);
  const int ball = Pixel(green.camera, {0, 0, 1});
  EXPECT_GT(green.rgb[3 * ball + 1], 2 * green.rgb[3 * ball]);
  EXPECT_EQ(green.ids, red.ids);
}

TEST_P(Rendering, MarkersAreInColourOnly) {
  const Images plain = Take(*renderer_);
  std::vector<Marker> markers;
  AddFrame(markers, Pose(Eigen::Vector3d(0, -1, 1)), 0.2);
  AddText(markers, {-0.8, -1, 0.3}, "here");
  AddPoint(markers, {0, -1, 0.6}, 0.05, {1, 1, 0, 1});
  Images marked = plain;
  renderer_->Render(data_.get(),
                    {.camera = ModelCamera{0}, .width = kW, .height = kH, .markers = markers},
                    {.rgb = marked.rgb, .depth = marked.depth, .segmentation = marked.ids});
  EXPECT_NE(marked.rgb, plain.rgb);
  EXPECT_EQ(marked.depth, plain.depth);
  EXPECT_EQ(marked.ids, plain.ids);
  const int x_tip = Pixel(plain.camera, {0.18, -1, 1}), z_tip = Pixel(plain.camera, {0, -1, 1.18});
  const int beyond = Pixel(plain.camera, {0.23, -1, 1});
  EXPECT_GT(marked.rgb[3 * x_tip], 2 * marked.rgb[3 * x_tip + 1]);  // red along x
  EXPECT_GT(marked.rgb[3 * z_tip + 2], 2 * marked.rgb[3 * z_tip]);  // blue along z
  EXPECT_EQ(marked.rgb[3 * beyond], plain.rgb[3 * beyond]);
  EXPECT_EQ(Take(*renderer_), plain);
}

TEST_P(Rendering, ARecompiledModelNeedsAnUpload) {
  SpecPtr spec = ParseXmlString(kSpheres);
  mjsBody* extra = mjs_addBody(mjs_findBody(spec.get(), "world"), nullptr);
  mjsGeom* geom = mjs_addGeom(extra, nullptr);
  geom->type = mjGEOM_SPHERE;
  geom->size[0] = 0.2;
  ModelPtr model = Compile(spec.get());
  DataPtr data = MakeData(model.get());
  std::vector<uint8_t> rgb(3 * kW * kH);
  const RenderRequest request{.camera = ModelCamera{0}, .width = kW, .height = kH};
  ExpectThrow<ArgumentError>(
      [&] { renderer_->Render(data.get(), request, {.rgb = rgb}); },
      "the data belong to another model; call SetModel after a scene was built again");
  renderer_->SetModel(model.get());
  renderer_->Render(data.get(), request, {.rgb = rgb});
}

// Freed memory is not read: the new model has the signature of the old one, and may even have its
// address.
TEST_P(Rendering, ReportsAFreedModelEvenIfTheNextOneIsIdentical) {
  std::vector<uint8_t> rgb(3 * kW * kH);
  const RenderRequest request{.camera = ModelCamera{0}, .width = kW, .height = kH};
  const auto compile = [] { return Compile(ParseXmlString(kSpheres).get()); };
  ModelPtr model = compile();
  renderer_->SetModel(model.get());
  const uint64_t signature = model->signature;
  model.reset();
  model = compile();
  ASSERT_EQ(model->signature, signature);
  const DataPtr data = MakeData(model.get());
  ExpectThrow<ArgumentError>(
      [&] { renderer_->Render(data.get(), request, {.rgb = rgb}); },
      "the model that it was given was freed; call SetModel after a scene was built again");
  renderer_->SetModel(model.get());
  renderer_->Render(data.get(), request, {.rgb = rgb});
}

TEST_P(Rendering, RejectsWrongBuffersAndSizes) {
  std::vector<uint8_t> rgb(10);
  ExpectThrow<ArgumentError>(
      [&] { renderer_->Render(data_.get(), {.width = 640, .height = 480}, {.rgb = rgb}); },
      "rgb buffer has 10 elements, an image of 640 x 480 pixels needs 921600");
  ExpectThrow<ArgumentError>(
      [&] { renderer_->Render(data_.get(), {.width = 0, .height = 480}, {}); },
      "an image of 0 x 480 pixels; each side must be between 1 and 16384");
  ExpectThrow<NotFoundError>([] { MakeRenderer({.backend = "vulkan"}); },
                             "renderer: no back end 'vulkan'. Its back ends: auto, gl, soft.");
  ExpectThrow<NotFoundError>([] { MakeRenderer({.backend = "gl", .gl = "elg"}); },
                             "Did you mean 'egl'?");
  ExpectThrow<ArgumentError>(
      [&] { MakeRenderer({.backend = GetParam()})->Render(data_.get(), {}, {}); },
      "call SetModel before Render");
}

TEST_P(Rendering, AllocatesNothingOnceWarm) {
  Images images = Take(*renderer_);
  std::vector<uint16_t> mm(kW * kH);
  const RenderRequest request{.camera = ModelCamera{0}, .width = kW, .height = kH};
  const RenderOutputs outputs{.rgb = images.rgb, .depth_mm = mm, .segmentation = images.ids};
  renderer_->Render(data_.get(), request, outputs);
  const AllocationCount count;
  renderer_->Render(data_.get(), request, outputs);
  EXPECT_EQ(count.allocations(), 0);
}

TEST(SoftEffects, AllocateNothingOnceWarm) {
  const ModelPtr model = Compile(ParseXmlString(kSpheres).get());
  const DataPtr data = MakeData(model.get());
  const RenderQuality effects{
      .shadows = true, .reflections = true, .multisamples = 4, .shadow_size = 512};
  const auto soft = MakeRenderer({.backend = "soft", .quality = effects});
  soft->SetModel(model.get());
  std::vector<uint8_t> rgb(3 * kW * kH);
  const RenderRequest request{.camera = ModelCamera{0}, .width = kW, .height = kH};
  soft->Render(data.get(), request, {.rgb = rgb});
  const AllocationCount count;
  soft->Render(data.get(), request, {.rgb = rgb});
  EXPECT_EQ(count.allocations(), 0);
}

// Returns the bytes of this process in memory.
long Resident() {
  long pages = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> pages >> resident;
  return resident * 4096;
}

int OpenFiles() {
  const std::filesystem::directory_iterator files("/proc/self/fd");
  return static_cast<int>(std::distance(begin(files), end(files)));
}

// A leak grows the process in every round; the driver's own pools only do so occasionally.
TEST_P(Rendering, RenderersAreFreedWithoutLeaks) {
  for (int i = 0; i < 2; ++i) Take(*Make({}), 16, 16);
  const int files = OpenFiles();
  long least_growth = std::numeric_limits<long>::max();
  for (int round = 0; round < 3; ++round) {
    const long memory = Resident();
    for (int i = 0; i < 3; ++i) Take(*Make({}), 16, 16);
    least_growth = std::min(least_growth, Resident() - memory);
  }
  EXPECT_EQ(OpenFiles(), files);
  // AddressSanitizer keeps freed memory for a while, and finds leaks itself at the end.
  const bool sanitized = dlsym(RTLD_DEFAULT, "__asan_init") != nullptr;
  if (!sanitized) {
    EXPECT_LT(least_growth, 3 * 300'000);
  }
}

INSTANTIATE_TEST_SUITE_P(BackEnds, Rendering, testing::ValuesIn(RendererBackends()),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace robocell
