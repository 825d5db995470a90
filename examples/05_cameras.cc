// Example 5: cameras: colour, depth in metres, the body seen in each pixel, and a video. Every
// measurement in an image is compared with the scene: a point is projected into the image, and
// pixels are turned back into points. The same in Python: 05_cameras.py.
//
//   build/release/example_05_cameras [folder for picture and video]
#include <robocell/robocell.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

namespace fs = std::filesystem;
namespace rc = robocell;

namespace {

constexpr int kWidth = 320, kHeight = 240;
using Colour = std::array<uint8_t, 3>;
constexpr std::array<Colour, 5> kColours = {
    {{230, 60, 50}, {50, 130, 220}, {250, 190, 40}, {60, 170, 90}, {150, 90, 200}}};

void Require(bool holds, const char* what) {
  if (!holds) throw rc::Error(what);
}

// The built-in robot, three objects in front of it, and a camera on the floor that looks at them.
rc::Scene Build() {
  rc::SceneSpec spec{.name = "cameras", .timestep = 0.002, .add_floor = true, .add_skybox = true};
  spec.robots.push_back(
      {.name = "rc7", .config = rc::RobotConfig::Load(rc::assets::BuiltinRobotFile("rc7"))});
  spec.objects.push_back(
      {.name = "mug", .mjcf_path = "mug", .pos = rc::Vec3{.55, -.15, .04}, .fixed = false});
  spec.objects.push_back(
      {.name = "bottle", .mjcf_path = "bottle", .pos = rc::Vec3{.6, .15, .09}, .fixed = false});
  spec.objects.push_back({.name = "ball",
                          .shape = rc::Shape::kSphere,
                          .size = rc::Vec3{.04, 0, 0},
                          .rgba = rc::Vec4{.9, .3, .2, 1},
                          .mass = .1,
                          .friction = rc::Vec3{.8, .02, .001},
                          .pos = rc::Vec3{.45, 0, .04}});
  spec.cameras.push_back({.name = "front",
                          .pos = rc::Vec3{1.3, .75, .85},
                          .fovy = 50,
                          .look_at = rc::Vec3{.25, 0, .4}});
  rc::Scene scene = rc::Scene::Build(spec);
  scene.Reset();
  return scene;
}

}  // namespace

int main(int argc, char** argv) try {
  const fs::path folder = argc > 1 ? argv[1] : fs::temp_directory_path() / "robocell_example_05";
  fs::create_directories(folder);
  const rc::Scene scene = Build();
  const auto renderer = rc::MakeRenderer({.quality = rc::NamedQuality("standard")});
  renderer->SetModel(scene.model());
  std::vector<uint8_t> rgb(kWidth * kHeight * 3);
  std::vector<float> depth(kWidth * kHeight);
  std::vector<int32_t> bodies(kWidth * kHeight);
  const rc::CameraView front = rc::NamedCamera(scene.model(), "front", "example 5");
  const rc::CameraModel camera =
      renderer->Render(scene.data(), {.camera = front, .width = kWidth, .height = kHeight},
                       {.rgb = rgb, .depth = depth, .segmentation = bodies});
  const std::vector<std::string> names = scene.body_names();
  const auto id_of = [&](const std::string& body) {
    return static_cast<int32_t>(std::find(names.begin(), names.end(), body) - names.begin());
  };
  std::printf("cameras:");
  for (const std::string& name : scene.camera_names()) std::printf(" %s", name.c_str());
  std::printf("\npixels of mug, bottle, ball:");
  for (const char* body : {"mug_mug", "bottle_bottle", "ball"})
    std::printf(" %td", std::count(bodies.begin(), bodies.end(), id_of(body)));

  // From the world into the image.
  const Eigen::Vector3d ball = scene.body_pose("ball").translation();
  const Eigen::Vector2d uv = camera.Project(ball);
  const size_t pixel = std::lround(uv.y()) * kWidth + std::lround(uv.x());
  std::printf("\nthe ball's middle is at pixel %.1f %.1f, %.3f m from the camera\n", uv.x(), uv.y(),
              camera.Depth(ball));
  Require(bodies[pixel] == id_of("ball"), "the ball is not where it was projected");
  std::printf("there the depth image says %.3f m, of the surface\n", depth[pixel]);

  // And back: every pixel of the ball is a point on its surface.
  std::vector<double> radius;
  for (int i = 0; i < kWidth * kHeight; ++i) {
    if (bodies[i] != id_of("ball")) continue;
    const Eigen::Vector3d point = camera.Unproject({i % kWidth, i / kWidth}, depth[i]);
    radius.push_back((point - ball).norm());
    Require(std::abs(radius.back() - .04) < .002, "the depth is wrong");
  }
  std::sort(radius.begin(), radius.end());
  std::printf("its %zu pixels lie %.1f mm from its middle\n", radius.size(),
              1000 * radius[radius.size() / 2]);

  // A picture of all three: colour, depth (near is bright), and a colour for each body.
  rc::RgbImage picture{3 * kWidth, kHeight, std::vector<uint8_t>(3 * rgb.size())};
  for (int i = 0; i < kWidth * kHeight; ++i) {
    const float near = depth[i] > 0 ? std::clamp((2.3F - depth[i]) / 1.6F, 0.F, 1.F) : 0;
    const auto grey = static_cast<uint8_t>(255 * near);
    const Colour body = bodies[i] > 0 ? kColours[bodies[i] % 5] : Colour{235, 235, 235};
    const std::array<Colour, 3> panels = {
        Colour{rgb[3 * i], rgb[3 * i + 1], rgb[3 * i + 2]}, {grey, grey, grey}, body};
    for (int panel = 0; panel < 3; ++panel) {
      const int to = (i / kWidth * 3 + panel) * kWidth + i % kWidth;
      std::copy(panels[panel].begin(), panels[panel].end(), &picture.pixels[3 * to]);
    }
  }
  rc::WritePng(folder / "picture.png", picture);

  // A video: one call, one frame. The camera goes around the robot.
  rc::SceneRecorder video(scene, folder / "around.mp4",
                          {.width = kWidth, .height = kHeight, .fps_num = 30});
  for (int degrees = 0; degrees < 360; degrees += 6) {
    video.SetFreeCamera(1.8, degrees, -20, {.3, 0, .3});
    video.RecordFrame();
  }
  video.Finish();
  std::printf("around.mp4: %td frames\n", static_cast<ptrdiff_t>(video.frames()));
  return 0;
} catch (const rc::Error& e) {
  std::fprintf(stderr, "error: %s\n", e.what());
  return 1;
}
