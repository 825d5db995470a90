// Tests the images of `soft` against OpenGL's exact pass, the engine's rays and other instruction
// sets.
#include <gtest/gtest.h>
#include <hwy/targets.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iterator>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/rng.h"
#include "robocell/mujoco/clip_planes.h"
#include "robocell/mujoco/compile.h"
#include "robocell/render/renderer.h"
#include "robocell/render/soft_renderer.h"
#include "robocell/render/testing/soft_images.h"
#include "robocell/spec/render_quality.h"
#include "robocell/testing/instruction_sets.h"
#include "robocell/testing/long_form.h"
#include "robocell/testing/menagerie.h"
#include "robocell/testing/skip.h"
#include "robocell/testing/source_dir.h"

namespace robocell::internal {
namespace {

// Every shape, textures of both kinds, lights of both kinds, and flexible objects.
constexpr char kZoo[] = R"(<mujoco>
  <option gravity="0 0 -9.81"/>
  <asset>
    <texture name="sky" type="skybox" builtin="gradient" rgb1=".3 .5 .7" rgb2="0 0 .2" width="64" height="384"/>
    <texture name="grid" type="2d" builtin="checker" rgb1=".2 .3 .4" rgb2=".7 .8 .9" width="128" height="128" mark="edge" markrgb=".9 .1 .1"/>
    <texture name="cube" type="cube" builtin="checker" rgb1=".8 .6 .4" rgb2=".4 .3 .2" width="64" height="64"/>
    <material name="floor" texture="grid" texrepeat="3 3" texuniform="true" reflectance=".3"/>
    <material name="wood" texture="cube" shininess=".2" specular=".2"/>
    <material name="wall" texture="grid" texrepeat="2 2"/>
    <hfield name="hills" nrow="12" ncol="14" size=".4 .3 .15 .05"/>
    <mesh name="tetra" vertex="0 0 0  .2 0 0  0 .2 0  0 0 .2"/>
  </asset>
  <visual><map haze=".3"/><quality numslices="96" numstacks="64"/></visual>
  <worldbody>
    <light type="directional" pos="0 0 3" dir=".2 .3 -1" diffuse=".5 .5 .5"/>
    <light type="spot" pos="1 -1 2" dir="-.4 .4 -1" cutoff="40" exponent="5" attenuation="1 .1 .05" diffuse=".6 .5 .4"/>
    <geom type="plane" size="0 0 .1" material="floor"/>
    <body name="wall"><geom type="plane" size=".5 .4 .1" pos="-.9 1.2 .5" euler="70 0 20" material="wall"/></body>
    <geom type="hfield" hfield="hills" pos="1.1 .9 .04" rgba=".4 .6 .3 1"/>
    <body name="sphere" pos="0 0 .5"><freejoint/><geom size=".15" rgba="1 0 0 1"/></body>
    <body name="capsule" pos=".5 0 .5"><freejoint/><geom type="capsule" size=".08 .2" rgba="0 1 0 1"/></body>
    <body name="cylinder" pos="-.5 0 .5"><freejoint/><geom type="cylinder" size=".1 .15" material="wood"/></body>
    <body name="ellipsoid" pos="0 .5 .5"><freejoint/><geom type="ellipsoid" size=".1 .2 .15" rgba="0 0 1 1"/></body>
    <body name="box" pos="0 -.5 .5"><freejoint/><geom type="box" size=".1 .15 .05" material="wood"/></body>
    <body name="mesh" pos=".5 .5 .5"><freejoint/><geom type="mesh" mesh="tetra" rgba=".9 .9 0 1"/></body>
    <body name="arm" pos="-.5 .5 .8"><joint type="ball"/><geom type="capsule" fromto="0 0 0 .3 0 0" size=".03"/>
      <site name="a" pos=".3 0 0"/></body>
    <site name="b" pos="-.5 .2 .3"/>
    <body pos="-.8 -.6 .6"><freejoint/>
      <geom type="box" size=".1 .1 .1" rgba=".2 .7 .7 .4"/></body>
  </worldbody>
  <tendon><spatial width=".01" rgba=".9 .4 .1 1"><site site="a"/><site site="b"/></spatial></tendon>
</mujoco>)";

// A model in random states, seen from random places.
class RandomViews {
 public:
  explicit RandomViews(const std::string& path)
      : RandomViews(path.empty() ? ParseXmlString(kZoo) : ParseXmlFile(path)) {}
  explicit RandomViews(SpecPtr spec) {
    SetClipPlanes(spec.get(), 1, 0.01, 30);
    model_ = Compile(spec.get());
    data_ = MakeData(model_.get());
  }

  void Next() {
    mj_resetData(model_.get(), data_.get());
    for (int j = 0; j < model_->njnt; ++j) {
      double* q = data_->qpos + model_->jnt_qposadr[j];
      switch (model_->jnt_type[j]) {
        case mjJNT_FREE:
          for (int k = 0; k < 3; ++k) q[k] += Random(-0.2, 0.2);
          Turn(q + 3);
          break;
        case mjJNT_BALL:
          Turn(q);
          break;
        default:
          *q = model_->jnt_limited[j]
                   ? Random(model_->jnt_range[2 * j], model_->jnt_range[2 * j + 1])
                   : Random(-2, 2);
      }
    }
    mj_forward(model_.get(), data_.get());
    do {
      view_ = OrbitCamera{.lookat = {Random(-0.2, 0.2), Random(-0.2, 0.2), Random(0.2, 0.6)},
                          .distance = Random(0.4, 3),
                          .azimuth = Random(0, 360),
                          .elevation = Random(-70, -2),
                          .fovy = Random(30, 75)};
    } while (StandsInABody());
  }
  const mjModel* model() const { return model_.get(); }
  const mjData* data() const { return data_.get(); }
  const OrbitCamera& view() const { return view_; }
  double Random(double low, double high) { return random_.Uniform(low, high); }

 private:
  // Rays hit the inside of shapes, which images do not show.
  bool StandsInABody() const {
    const Eigen::Vector3d eye = view_.camera_in_world().translation();
    for (int b = 1; b < model_->nbody; ++b) {
      if ((eye - Eigen::Map<const Eigen::Vector3d>(data_->xpos + 3 * b)).norm() < 0.3) return true;
    }
    return false;
  }
  void Turn(double* q) {
    for (int k = 0; k < 4; ++k) q[k] = Random(-1, 1);
    mju_normalize4(q);
  }

  Rng random_ = Rng::Stream(7, "views");
  ModelPtr model_;
  DataPtr data_;
  OrbitCamera view_;
};

// Returns the depth of the surface that the ray through a pixel hits; 0 for none.
double DepthOfRay(const RandomViews& views, const CameraModel& camera, int x, int y,
                  int* geom = nullptr) {
  const Eigen::Vector3d eye = camera.camera_in_world.translation();
  const Eigen::Vector3d along =
      camera.Unproject({static_cast<double>(x), static_cast<double>(y)}, 1) - eye;
  const mjtByte groups[mjNGROUP] = {1, 1, 1, 0, 0, 0};
  int met = -1;
  const double depth =
      mj_ray(views.model(), views.data(), eye.data(), along.data(), groups, 1, -1, &met, nullptr);
  if (geom) *geom = met;
  return met < 0 ? 0 : depth;
}

class SoftAgrees : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    if (GetParam() != "zoo") REQUIRE_MENAGERIE(Folder());
  }
  static std::string Folder() { return GetParam().substr(0, GetParam().find('/')); }
  static std::string Path() {
    if (GetParam() == "zoo") return "";
    return MenagerieModel(Folder(), GetParam().substr(GetParam().find('/') + 1));
  }
};

// Compares both back ends' images of random states from random places. `what` begins what is
// reported.
void ExpectAgreement(const std::string& what, RandomViews& views, int count, Renderer& gl,
                     Renderer& soft) {
  gl.SetModel(views.model());
  soft.SetModel(views.model());
  int ids = 0, depth = 0, coarse = 0;
  double least_similar = 1;
  for (int i = 0; i < count; ++i) {
    views.Next();
    const SoftImages a = TakeOf(gl, views.data(), views.view()),
                     b = TakeOf(soft, views.data(), views.view());
    int ids_here = 0, depth_here = 0;
    for (int k = 0; k < kShown; ++k) {
      ids_here += a.ids[k] != b.ids[k];
      if (std::abs(a.depth[k] - b.depth[k]) <= 1e-3f) continue;
      // Far away the steps of OpenGL's depth buffer are millimetres, as FarAway shows in
      // soft_kinds_test.cc: there the engine's rays decide.
      const double ray = DepthOfRay(views, b.camera, k % kAcross, k / kAcross);
      if (b.depth[k] > 4 && std::abs(ray - b.depth[k]) <= 1e-3) {
        ++coarse;
      } else {
        ++depth_here;
      }
    }
    EXPECT_LE(ids_here, 1e-3 * kShown) << what << ", view " << i;
    EXPECT_LE(depth_here, 1e-3 * kShown) << what << ", view " << i;
    const double similar = Similarity(a.rgb, b.rgb);
    EXPECT_GE(similar, 0.95) << what << ", view " << i;
    least_similar = std::min(least_similar, similar);
    ids += ids_here;
    depth += depth_here;
  }
  if (std::getenv("ROBOCELL_TEST_VERBOSE")) {
    std::printf("%s: ids differ in %.4f %%, depth in %.4f %%, least similarity %.4f\n",
                what.c_str(), 100.0 * ids / (count * kShown), 100.0 * depth / (count * kShown),
                least_similar);
    std::printf("%s: OpenGL's depth is wrong in %.4f %%\n", what.c_str(),
                100.0 * coarse / (count * kShown));
  }
}

TEST_P(SoftAgrees, WithOpenGl) {
  RandomViews views(Path());
  const std::unique_ptr<Renderer> soft = MakeRenderer({.backend = "soft"});
  std::unique_ptr<Renderer> gl;
  try {
    gl = MakeRenderer({.backend = "gl"});
  } catch (const Error& error) {
    SKIP_OR_FAIL(error.what());
  }
  ExpectAgreement(GetParam(), views, 10, *gl, *soft);
}

// Takes minutes: tests/integration/test_soft_agreement.py runs it (make check-proofs).
TEST(SoftAgreesLong, DISABLED_WithOpenGlOnEveryModel) {
  namespace fs = std::filesystem;
  REQUIRE_MENAGERIE();
  const std::unique_ptr<Renderer> soft = MakeRenderer({.backend = "soft"}),
                                  gl = MakeRenderer({.backend = "gl"});
  const fs::path menagerie = fs::path(MenagerieModel(MenagerieTestModels().front())).parent_path();
  std::vector<fs::path> files;
  for (const fs::path& root : {menagerie, fs::path(SourceDir()) / "models"}) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root)) {
      if (entry.path().extension() == ".xml") files.push_back(entry.path());
    }
  }
  std::ranges::sort(files);
  int models = 0;
  for (const fs::path& file : files) {
    std::optional<RandomViews> views;
    try {
      views.emplace(file.string());
    } catch (const Error&) {
      continue;  // a part that another file includes
    }
    if (views->model()->ngeom == 0) continue;
    ++models;
    ExpectAgreement(file.parent_path().filename().string() + "/" + file.filename().string(), *views,
                    20, *gl, *soft);
  }
  EXPECT_GE(models, 25) << files.size() << " files";
  std::printf("%d models agree\n", models);
}

// Compares with rays of the engine, from the camera through pixels. They hit the true shapes, where
// images show round ones in facets, and no tendons.
TEST_P(SoftAgrees, WithTheEnginesRays) {
  RandomViews views(Path());
  const std::unique_ptr<Renderer> soft = MakeRenderer({.backend = "soft"});
  soft->SetModel(views.model());
  const int wall = mj_name2id(views.model(), mjOBJ_BODY, "wall");
  int rays = 0, ids = 0, depth = 0;
  for (int i = 0; i < 10; ++i) {
    views.Next();
    const SoftImages images = TakeOf(*soft, views.data(), views.view());
    for (int k = 0; k < 100; ++k) {
      const int x = static_cast<int>(views.Random(1, kAcross - 1)),
                y = static_cast<int>(views.Random(1, kDown - 1)), pixel = y * kAcross + x;
      // Rays pass through the back of planes, which images show.
      if (wall > 0 && images.ids[pixel] == wall) continue;
      int geom = -1;
      const double far = DepthOfRay(views, images.camera, x, y, &geom);
      if (geom >= 0 && (far < 0.0101 || far > 29)) continue;  // clipped in the image
      ++rays;
      const int body = geom < 0 ? -1 : views.model()->geom_bodyid[geom];
      ids += body != images.ids[pixel];
      depth += body == images.ids[pixel] && std::abs(far - images.depth[pixel]) > 1e-3;
    }
  }
  EXPECT_GT(rays, 900);
  EXPECT_LE(ids, 0.02 * rays);  // facets and tendons
  EXPECT_LE(depth, 0.02 * rays);
  if (std::getenv("ROBOCELL_TEST_VERBOSE")) {
    std::printf("%s: of %d rays %d other bodies, %d other depths\n", GetParam().c_str(), rays, ids,
                depth);
  }
}

// Calls `test` with SSE4 and nothing wider, which other kernels do not have.
void OnSse4(const std::function<void()>& test) {
  hwy::SetSupportedTargetsForTest(-HWY_SSE4);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  test();
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

TEST_P(SoftAgrees, WithItselfOnEveryInstructionSet) {
  RandomViews views(Path());
  views.Next();
  std::set<std::string> descriptions;
  // Runs of blocks have no reflection; the pixels of coarse maps are larger than those of the image.
  const RenderQuality qualities[] = {
      {.shadows = true, .reflections = true, .multisamples = 4, .shadow_size = 512},
      {.shadows = true, .multisamples = 4, .shadow_size = 128}};
  std::unique_ptr<SoftImages> first[std::size(qualities)];
  const auto draw = [&] {
    for (size_t i = 0; i < std::size(qualities); ++i) {
      const std::unique_ptr<Renderer> soft =
          MakeRenderer({.backend = "soft", .quality = qualities[i]});
      descriptions.insert(soft->description());
      soft->SetModel(views.model());
      SoftImages images = TakeOf(*soft, views.data(), views.view());
      if (!first[i]) first[i] = std::make_unique<SoftImages>(images);
      EXPECT_EQ(first[i]->rgb, images.rgb) << soft->description() << ", quality " << i;
      EXPECT_EQ(first[i]->depth, images.depth) << soft->description() << ", quality " << i;
      EXPECT_EQ(first[i]->ids, images.ids) << soft->description() << ", quality " << i;
    }
  };
  OnEveryInstructionSet([&](const std::string&) { draw(); });
  OnSse4(draw);
  if (std::getenv("ROBOCELL_TEST_VERBOSE")) {
    for (const std::string& one : descriptions) std::printf("same bytes: %s\n", one.c_str());
  }
}

// Images are divided into rows; what is drawn across several of them is the same.
TEST_P(SoftAgrees, WithItselfOnAnyNumberOfThreads) {
  RandomViews views(Path());
  std::vector<std::unique_ptr<Renderer>> renderers;
  for (const int threads : {1, 2, 3, 7}) {
    renderers.push_back(MakeRenderer(
        {.backend = "soft",
         .quality = {.shadows = true, .reflections = true, .multisamples = 4, .shadow_size = 512},
         .threads = threads}));
    renderers.back()->SetModel(views.model());
  }
  for (int i = 0; i < 3; ++i) {
    views.Next();
    const SoftImages one = TakeOf(*renderers[0], views.data(), views.view());
    for (size_t k = 1; k < renderers.size(); ++k) {
      const SoftImages several = TakeOf(*renderers[k], views.data(), views.view());
      EXPECT_EQ(one.rgb, several.rgb) << "view " << i << ", renderer " << k;
      EXPECT_EQ(one.depth, several.depth) << "view " << i << ", renderer " << k;
      EXPECT_EQ(one.ids, several.ids) << "view " << i << ", renderer " << k;
    }
  }
}

// Tests shadows and reflections. Shadows are softer than OpenGL's, and at the same places.
TEST_P(SoftAgrees, WithOpenGlOnShadowsAndReflections) {
  RandomViews views(Path());
  RendererOptions options{
      .quality = {.shadows = true, .reflections = true, .multisamples = 4, .shadow_size = 2048}};
  std::unique_ptr<Renderer> gl, soft;
  try {
    options.backend = "gl";
    gl = MakeRenderer(options);
  } catch (const Error& error) {
    SKIP_OR_FAIL(error.what());
  }
  options.backend = "soft";
  soft = MakeRenderer(options);
  gl->SetModel(views.model());
  soft->SetModel(views.model());
  for (int i = 0; i < 3; ++i) {
    views.Next();
    const double similar = Similarity(TakeOf(*gl, views.data(), views.view()).rgb,
                                      TakeOf(*soft, views.data(), views.view()).rgb);
    EXPECT_GE(similar, 0.9) << "view " << i;
    if (std::getenv("ROBOCELL_TEST_VERBOSE")) {
      std::printf("%s: with effects, similarity %.4f\n", GetParam().c_str(), similar);
    }
  }
}

std::vector<std::string> ModelsToDraw() {
  std::vector<std::string> models = {"zoo", "ufactory_xarm7/scene.xml", "robotiq_2f85/scene.xml"};
  if (LongForm()) {
    models.insert(models.end(), {"franka_emika_panda/scene.xml", "franka_fr3/scene.xml",
                                 "kinova_gen3/scene.xml"});
  }
  return models;
}

INSTANTIATE_TEST_SUITE_P(Models, SoftAgrees, testing::ValuesIn(ModelsToDraw()),
                         [](const auto& info) {
                           return info.param.substr(0, info.param.find('/'));
                         });

constexpr RenderQuality kEffects{
    .shadows = true, .reflections = true, .multisamples = 4, .shadow_size = 512};

// A shadow map is kept while nothing in it has moved.
TEST(SoftEffects, DoNotDependOnEarlierFrames) {
  RandomViews views("");
  const auto make = [&] {
    auto renderer = MakeRenderer({.backend = "soft", .quality = kEffects});
    renderer->SetModel(views.model());
    return renderer;
  };
  const auto kept = make();
  for (int i = 0; i < 4; ++i) {
    views.Next();
    for (int camera = 0; camera < 2; ++camera) {
      OrbitCamera view = views.view();
      view.azimuth += 40 * camera;
      EXPECT_EQ(TakeOf(*kept, views.data(), view).rgb, TakeOf(*make(), views.data(), view).rgb)
          << "state " << i << ", camera " << camera;
    }
  }
}

// Prints the time of each stage of an image on request.
TEST(SoftStages, ComposeTheImage) {
  for (const char* quality : {"fast", "standard"}) {
    RandomViews views("");
    views.Next();
    SoftRenderer renderer({.quality = NamedQuality(quality)});
    renderer.SetModel(views.model());
    TakeOf(renderer, views.data(), views.view());
    constexpr int kImages = 10;
    renderer.clock().Run();
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < kImages; ++i) {
      views.Next();  // from elsewhere: no part of a picture is kept
      TakeOf(renderer, views.data(), views.view());
    }
    const double all =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
    double sum = 0;
    for (size_t k = 0; k < kSoftStageNames.size(); ++k) {
      const double stage = renderer.clock().milliseconds(static_cast<SoftStage>(k));
      EXPECT_GE(stage, 0);
      sum += stage;
      if (std::getenv("ROBOCELL_TEST_VERBOSE")) {
        std::printf("%s: %s %.3f ms\n", quality, kSoftStageNames[k], stage / kImages);
      }
    }
    EXPECT_GT(sum, 0);
    EXPECT_LE(sum, all);
  }
}

}  // namespace
}  // namespace robocell::internal
