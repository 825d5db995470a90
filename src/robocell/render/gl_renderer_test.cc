// Tests that cameras, images, depth and segmentation agree: coloured spheres all over the image, at
// several sizes and with several kinds of cameras, are found where CameraModel projects them. Runs
// on EGL (or the library of auto), and again in a child process on OSMesa, since one process can
// use only one OpenGL library.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <cstdlib>
#include <Eigen/Geometry>

#include "robocell/base/error.h"
#include "robocell/base/rng.h"
#include "robocell/mujoco/clip_planes.h"
#include "robocell/mujoco/compile.h"
#include "robocell/render/gl_context.h"
#include "robocell/render/renderer.h"
#include "robocell/testing/child_test.h"
#include "robocell/testing/skip.h"

namespace robocell::internal {
namespace {

constexpr int kColumns = 6, kRows = 5, kMarkers = kColumns * kRows;

struct Colour {
  int r, g, b;
};

// Colours that are far apart, and not black.
Colour MarkerColour(int i) {
  return {55 + 40 * (i % 6), 55 + 40 * (i / 6), 255 - 40 * ((i * 7) % 6)};
}

// Emission 0.7 and the 0.3 of ambient light that the engine gives scenes without lights add up to
// the plain colour.
std::string MarkerScene() {
  std::string bodies, materials;
  for (int i = 0; i < kMarkers; ++i) {
    const Colour c = MarkerColour(i);
    materials += fmt::format("<material name='m{}' rgba='{} {} {} 1' emission='.7' specular='0'/>",
                             i, c.r / 255.0, c.g / 255.0, c.b / 255.0);
    bodies += fmt::format(
        "<body name='marker{0}' mocap='true'><geom size='.02' material='m{0}'/></body>", i);
  }
  return "<mujoco><visual><headlight active='0'/><quality numslices='64' "
         "numstacks='64'/></visual><asset>" +
         materials +
         R"(</asset><worldbody>
         <body name="wall" mocap="true"><geom type="box" size="30 30 .05" rgba="0 0 0 1" group="1"/></body>
         <body name="carrier" mocap="true">
           <camera name="plain" fovy="65" pos=".1 0 .2" euler="20 -30 40"/>
           <camera name="lens" pos="-.2 .1 0" euler="100 10 0" resolution="640 480" sensorsize="0.0064 0.0048"
                   focalpixel="430 455" principalpixel="31 -17"/></body>)" +
         bodies + "</worldbody></mujoco>";
}

struct Blob {
  double u = 0, v = 0, n = 0;
};

class Projection : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    SpecPtr spec = ParseXmlString(MarkerScene());
    SetClipPlanes(spec.get(), 2, 0.01, 50);
    model_ = Compile(spec.get());
    data_ = MakeData(model_.get());
    try {
      renderer_ = MakeRenderer();
      renderer_->SetModel(model_.get());
    } catch (const Error& error) {
      missing_ = error.what();
    }
  }
  static void TearDownTestSuite() {
    renderer_.reset();
    data_.reset();
    model_.reset();
  }
  void SetUp() override {
    if (!renderer_) SKIP_OR_FAIL(missing_);
  }

  int Body(const std::string& name) { return mj_name2id(model_.get(), mjOBJ_BODY, name.c_str()); }

  void Move(int body, const Pose& pose) {
    const int mocap = model_->body_mocapid[body];
    for (int i = 0; i < 3; ++i) data_->mocap_pos[3 * mocap + i] = pose.translation()[i];
    const Quaternion q = pose.quaternion_wxyz();
    for (int i = 0; i < 4; ++i) data_->mocap_quat[4 * mocap + i] = q[i];
  }

  // Returns the camera's model without drawing, for placing the markers.
  CameraModel Where(const CameraView& view, int width, int height) {
    mj_forward(model_.get(), data_.get());
    return ComputeCamera(model_.get(), data_.get(), view, width, height);
  }

  // Places one marker in each cell of a grid over the image, 1 to 2 m away, small enough not to
  // hide another one.
  void Scatter(const CameraModel& camera, Rng& rng) {
    const double w = camera.width / double(kColumns), h = camera.height / double(kRows);
    const double pixels = 0.2 * std::min(w, h);
    for (int i = 0; i < kMarkers; ++i) {
      const double u = (i % kColumns + rng.Uniform(0.3, 0.7)) * w,
                   v = (i / kColumns + rng.Uniform(0.3, 0.7)) * h;
      const double depth = rng.Uniform(1, 2);
      Move(Body(fmt::format("marker{}", i)), Pose(camera.Unproject({u, v}, depth)));
      model_->geom_size[3 * model_->body_geomadr[Body(fmt::format("marker{}", i))]] =
          pixels / camera.fx * depth;
    }
  }

  // The centre of a sphere's image differs from the image of its centre.
  Eigen::Vector2d SphereImage(const CameraModel& camera, int i) {
    const int body = Body(fmt::format("marker{}", i));
    const Eigen::Vector3d centre =
        Eigen::Map<const Eigen::Vector3d>(data_->mocap_pos + 3 * model_->body_mocapid[body]);
    const double r = model_->geom_size[3 * model_->body_geomadr[body]];
    const Eigen::Vector3d p = (camera.extrinsics() * centre.homogeneous().eval()).head<3>();
    const double z = p.z() * p.z() - r * r;
    return {camera.cx + camera.fx * p.x() * p.z() / z, camera.cy + camera.fy * p.y() * p.z() / z};
  }

  static inline ModelPtr model_;
  static inline DataPtr data_;
  static inline std::unique_ptr<Renderer> renderer_;
  static inline std::string missing_;
};

std::vector<Blob> FindColours(const std::vector<uint8_t>& rgb, int width) {
  std::vector<Blob> blobs(kMarkers);
  for (size_t p = 0; p < rgb.size() / 3; ++p) {
    for (int i = 0; i < kMarkers; ++i) {
      const Colour c = MarkerColour(i);
      const int off = std::abs(rgb[3 * p] - c.r) + std::abs(rgb[3 * p + 1] - c.g) +
                      std::abs(rgb[3 * p + 2] - c.b);
      if (off > 6) continue;
      blobs[i].u += static_cast<double>(p % width);
      blobs[i].v += static_cast<double>(p / width);
      blobs[i].n += 1;
    }
  }
  for (Blob& b : blobs) {
    b.u /= b.n;
    b.v /= b.n;
  }
  return blobs;
}

struct View {
  const char* name;
  CameraView view;
  int width, height;
};

TEST_F(Projection, MatchesColouredMarkers) {
  Rng rng = Rng::Stream(7, "markers");
  Move(Body("wall"), Pose(Eigen::Vector3d(0, 0, -100)));
  Move(Body("carrier"), Pose::FromRpy({0.3, -0.5, 0.8}, {0.4, -0.2, 1.1}));
  const Pose free = Pose::FromRpy({1, 2, 0.5}, {0.9, 0.1, -0.7});
  const View views[] = {
      {"model camera", NamedCamera(model_.get(), "plain", ""), 320, 240},
      {"odd size", NamedCamera(model_.get(), "plain", ""), 321, 241},
      {"wide", NamedCamera(model_.get(), "plain", ""), 427, 240},
      {"tall", FreeCamera{free, 80}, 199, 303},
      {"free", FreeCamera{free, 40}, 320, 240},
      {"orbit", OrbitCamera{.lookat = {1, 0, 0}, .azimuth = 20, .fovy = 55}, 320, 240},
      {"lens", NamedCamera(model_.get(), "lens", ""), 320, 240},
      {"lens, odd size", NamedCamera(model_.get(), "lens", ""), 481, 361}};
  double sum_u = 0, sum_v = 0, worst = 0;
  int count = 0;
  for (const View& view : views) {
    const CameraModel where = Where(view.view, view.width, view.height);
    Scatter(where, rng);
    std::vector<uint8_t> rgb(3 * view.width * view.height);
    std::vector<int32_t> ids(view.width * view.height);
    const CameraModel camera = renderer_->Render(
        data_.get(), {.camera = view.view, .width = view.width, .height = view.height},
        {.rgb = rgb, .segmentation = ids});
    const std::vector<Blob> blobs = FindColours(rgb, view.width);
    for (int i = 0; i < kMarkers; ++i) {
      const Eigen::Vector2d expected = SphereImage(camera, i);
      ASSERT_GT(blobs[i].n, 80) << view.name << " marker " << i;
      const double du = blobs[i].u - expected.x(), dv = blobs[i].v - expected.y();
      EXPECT_LT(std::hypot(du, dv), 0.35) << view.name << " marker " << i;
      sum_u += du;
      sum_v += dv;
      worst = std::max(worst, std::hypot(du, dv));
      ++count;
      const int u = static_cast<int>(std::lround(expected.x())),
                v = static_cast<int>(std::lround(expected.y()));
      EXPECT_EQ(ids[v * view.width + u], Body(fmt::format("marker{}", i))) << view.name;
    }
  }
  EXPECT_LT(std::abs(sum_u / count), 0.05);
  EXPECT_LT(std::abs(sum_v / count), 0.05);
  RecordProperty("bias_u_px", fmt::format("{:.4f}", sum_u / count));
  RecordProperty("bias_v_px", fmt::format("{:.4f}", sum_v / count));
  RecordProperty("worst_px", fmt::format("{:.3f}", worst));
  if (std::getenv("ROBOCELL_TEST_VERBOSE")) {
    fmt::print("{}: bias {:.4f} {:.4f} px, worst {:.3f} px over {} markers\n",
               renderer_->description(), sum_u / count, sum_v / count, worst, count);
  }
}

TEST_F(Projection, MeasuresATiltedWallToAMillimetre) {
  for (int i = 0; i < kMarkers; ++i)
    Move(Body(fmt::format("marker{}", i)), Pose(Eigen::Vector3d(0, 0, -50)));
  const CameraView view = FreeCamera{Pose(Eigen::Vector3d(0, 0, 0)), 60};  // looks along -z
  constexpr int kW = 161, kH = 120;
  std::vector<float> depth(kW * kH);
  std::vector<uint16_t> mm(kW * kH);
  std::vector<int32_t> ids(kW * kH);
  for (double distance : {0.05, 0.5, 2.0, 10.0}) {
    // Half a box behind its face, turned: the face passes through (0, 0, -distance).
    const Pose face = Pose::FromRpy({0, 0, -distance}, {0.3, -0.4, 0});
    Move(Body("wall"), face * Pose(Eigen::Vector3d(0, 0, -0.05)));
    const CameraModel camera =
        renderer_->Render(data_.get(), {.camera = view, .width = kW, .height = kH},
                          {.depth = depth, .depth_mm = mm, .segmentation = ids});
    const Eigen::Vector3d normal = face.rotation().col(2);
    double worst = 0;
    for (int v = 0; v < kH; ++v) {
      for (int u = 0; u < kW; ++u) {
        const Eigen::Vector3d ray = camera.Unproject(Eigen::Vector2d(u, v), 1);  // from the origin
        const double expected = normal.dot(face.translation()) / normal.dot(ray);
        worst = std::max(worst, std::abs(depth[v * kW + u] - expected));
        ASSERT_NEAR(mm[v * kW + u], 1000 * expected, 1.01);
        ASSERT_EQ(ids[v * kW + u], Body("wall"));
      }
    }
    EXPECT_LT(worst, 1e-3) << "at " << distance << " m";
  }
}

TEST_F(Projection, TheBackgroundHasZeroDepthAndNoBody) {
  Move(Body("wall"), Pose(Eigen::Vector3d(0, 0, -2)));
  std::vector<float> depth(64);
  std::vector<uint16_t> mm(64);
  std::vector<int32_t> ids(64);
  const CameraView away = FreeCamera{LookAt({0, 0, 5}, {0, 0, 9}), 60};
  renderer_->Render(data_.get(), {.camera = away, .width = 8, .height = 8},
                    {.depth = depth, .depth_mm = mm, .segmentation = ids});
  EXPECT_THAT(depth, testing::Each(0));
  EXPECT_THAT(mm, testing::Each(0));
  EXPECT_THAT(ids, testing::Each(-1));
}

TEST_F(Projection, HoldsOnOsmesa) {
  if (GlBackendFromEnvironment() == GlBackend::kOsmesa) return;  // this is OSMesa
  const ChildRun run = RunTestsInChild("Projection.*:-*HoldsOnOsmesa", "ROBOCELL_GL=osmesa");
  if (run.skipped) SKIP_OR_FAIL("no OSMesa on this machine (libosmesa6):\n" + run.output);
  EXPECT_TRUE(run.passed) << run.output;
  EXPECT_THAT(run.output, testing::HasSubstr("[  PASSED  ] 3 tests"));
}

}  // namespace
}  // namespace robocell::internal
