// Example 8: objects are added and removed while the robot moves. A bottle is added by compiling
// the scene anew: everything else continues to the bit. Cubes come from the scene's pool, which
// takes microseconds, and a reset hook selects those of the next episode. The same in Python:
// 08_come_and_go.py.
//
//   build/release/example_08_come_and_go [folder for picture]
#include <robocell/robocell.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

namespace fs = std::filesystem;
namespace rc = robocell;

namespace {

constexpr int kWidth = 320, kHeight = 240;

void Require(bool holds, const char* what) {
  if (!holds) throw rc::Error(what);
}

// The built-in robot, a camera, and a pool of four cubes.
rc::Scene Build() {
  rc::SceneSpec spec{
      .name = "come_and_go", .timestep = 0.002, .add_floor = true, .add_skybox = true};
  spec.robots.push_back(
      {.name = "rc7", .config = rc::RobotConfig::Load(rc::assets::BuiltinRobotFile("rc7"))});
  for (int i = 0; i < 4; ++i) {
    spec.objects.push_back({.name = "cube" + std::to_string(i),
                            .shape = rc::Shape::kBox,
                            .size = rc::Vec3{.03, .03, .03},
                            .rgba = rc::Vec4{.9, .2 + .2 * i, .2, 1},
                            .mass = .1,
                            .friction = rc::Vec3{.8, .02, .001},
                            .pos = rc::Vec3{.5, .12 * i - .18, .03},
                            .parked = true});  // in the pool, and outside the scene after a reset
  }
  spec.cameras.push_back({.name = "front",
                          .pos = rc::Vec3{1.3, .75, .85},
                          .fovy = 50,
                          .look_at = rc::Vec3{.25, 0, .3}});
  return rc::Scene::Build(spec);
}

std::string Joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : " ") + name;
  return text;
}

void Report(const rc::Scene& scene, const char* what) {
  std::printf("%.3f s, %s: there are [%s], parked [%s]\n", scene.time(), what,
              Joined(scene.object_names()).c_str(), Joined(scene.parked_objects()).c_str());
}

void Run(rc::Robot& robot, int steps) {
  for (int i = 0; i < steps; ++i) {
    robot.Update();
    Require(robot.Step().ok(), "the simulation diverged");
  }
}

// Puts the camera's image into the n-th panel.
void Picture(rc::SceneRenderer& renderer, int n, rc::RgbImage& panels) {
  std::vector<uint8_t> rgb(3 * kWidth * kHeight);
  renderer.Render({.camera = renderer.Camera("front"), .width = kWidth, .height = kHeight},
                  {.rgb = rgb});
  for (int row = 0; row < kHeight; ++row)
    std::copy_n(&rgb[3 * row * kWidth], 3 * kWidth, &panels.pixels[3 * kWidth * (3 * row + n)]);
}

}  // namespace

int main(int argc, char** argv) try {
  const fs::path folder = argc > 1 ? argv[1] : fs::temp_directory_path() / "robocell_example_08";
  fs::create_directories(folder);
  rc::Scene scene = Build();
  rc::Robot robot = rc::Robot::Of(scene, "rc7");
  rc::SceneRenderer renderer(scene, {.quality = rc::NamedQuality("standard")});
  rc::RgbImage panels{3 * kWidth, kHeight, std::vector<uint8_t>(9 * kWidth * kHeight)};

  // Added by compiling, in the middle of a motion. The handles stay valid.
  robot.jnt_pos_cmd()[0] += .6;
  Run(robot, 100);
  const std::vector<double> moving = robot.arm().joint_vel();
  const rc::SceneObject bottle{
      .name = "bottle", .mjcf_path = "bottle", .pos = rc::Vec3{.65, .2, .09}, .fixed = false};
  scene.AddObject(bottle);
  Require(robot.arm().joint_vel() == moving, "the arm was disturbed");
  Report(scene, "a bottle");
  Run(robot, 400);
  std::printf("the arm went on to %.3f rad\n", robot.arm().joint_pos()[0]);
  Picture(renderer, 0, panels);

  // Added from the pool. Nothing is compiled.
  const mjModel* model = scene.model();
  for (int i = 0; i < 4; ++i) {
    scene.AddObject("cube" + std::to_string(i), rc::Pose(Eigen::Vector3d(.45, -.2, .05 + .07 * i)));
    Run(robot, 50);
  }
  Run(robot, 300);
  Require(scene.model() == model, "the scene was compiled anew");
  Report(scene, "four cubes");
  std::printf("the highest stands at %.0f mm\n", 1000 * scene.body_pose("cube3").translation().z());
  Picture(renderer, 1, panels);

  // An invalid change is rejected with the reason, and changes nothing.
  try {
    scene.AddObject(bottle);
  } catch (const rc::ArgumentError& error) {
    std::printf("%s\n", error.what());
  }
  scene.RemoveObject("bottle");
  scene.RemoveObject("cube1");
  Report(scene, "less");

  // A reset restores the pool of the spec; a hook selects the objects of the episode.
  scene.AddResetHook([](rc::ResetContext& reset) { reset.scene.AddObject("cube2"); });
  scene.Reset();
  Report(scene, "reset");
  Picture(renderer, 2, panels);
  rc::WritePng(folder / "picture.png", panels);
  return 0;
} catch (const rc::Error& e) {
  std::fprintf(stderr, "error: %s\n", e.what());
  return 1;
}
