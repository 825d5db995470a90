// Example 12: two arms carry a board together, and the object on it stays in place. There is one
// path, the board's; each hand keeps its place on it. Both arms are compliant (Cartesian
// impedance), so that they do not fight over millimetres. The same in Python: 12_two_arms.py.
//
//   build/release/example_12_two_arms [folder for picture]
#include <robocell/robocell.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

namespace fs = std::filesystem;
namespace rc = robocell;

namespace {

constexpr double kDegree = std::numbers::pi / 180;  // rad

rc::Pose Shift(double x, double y, double z) { return rc::Pose(Eigen::Vector3d(x, y, z)); }

// The pose of each hand on the board, and its approach: pointing down, from 12 cm above.
const rc::Pose kLeft({-.17, 0, 0}, rc::Quaternion{1, 0, 0, 0});
const rc::Pose kRight({.17, 0, 0}, rc::Quaternion{0, 1, 0, 0});
const rc::Pose kBefore = Shift(0, 0, -.12);

// Two of the built-in robot on one table, face to face, and a board with a cube between them.
rc::Scene Build() {
  rc::SceneSpec spec{.name = "two_arms", .timestep = 0.002, .add_floor = true, .add_skybox = true};
  spec.objects.push_back({.name = "table", .mjcf_path = "table", .pos = rc::Vec3{0, 0, .7}});
  rc::RobotConfig config = rc::RobotConfig::Load(rc::assets::BuiltinRobotFile("rc7"));
  config.base = {};  // it needs no pedestal
  spec.robots.push_back({.name = "left", .config = config, .prefix = "left_", .pos = {-.5, 0, .7}});
  spec.robots.push_back({.name = "right",
                         .config = config,
                         .prefix = "right_",
                         .pos = {.5, 0, .7},
                         .euler = {0, 0, 180}});
  spec.objects.push_back({.name = "board",
                          .shape = rc::Shape::kBox,
                          .size = rc::Vec3{.24, .03, .01},
                          .rgba = rc::Vec4{.45, .3, .2, 1},
                          .mass = .3,
                          .friction = rc::Vec3{1, .02, .001},
                          .condim = rc::Condim::kTorsional,
                          .pos = rc::Vec3{0, -.1, .71}});
  spec.objects.push_back({.name = "cube",
                          .shape = rc::Shape::kBox,
                          .size = rc::Vec3{.02, .02, .02},
                          .rgba = rc::Vec4{.85, .25, .18, 1},
                          .mass = .1,
                          .friction = rc::Vec3{1, .02, .001},
                          .pos = rc::Vec3{0, -.1, .74}});
  rc::Scene scene = rc::Scene::Build(spec);
  scene.Reset();
  return scene;
}

// One of the two arms, on springs; poses are its TCP's in the world.
struct Arm {
  rc::Robot robot;
  rc::Pose grasp;
  rc::Pose pose = robot.tcp_in_world();  // the target of the springs
  rc::Pose home = pose;
  rc::CartesianImpedanceController& spring =
      robot.SetController<rc::CartesianImpedanceController>("arm");
};

using Arms = std::vector<Arm>;
using Path = std::function<rc::Pose(const Arm&, double)>;

Arms BothArms(const rc::Scene& scene) {
  Arms arms = {{rc::Robot::Of(scene, "left"), kLeft}, {rc::Robot::Of(scene, "right"), kRight}};
  for (const Arm& arm : arms)
    arm.spring.SetStiffness({1500, 1500, 1500, 60, 60, 60});  // N/m, Nm/rad
  return arms;
}

// Moves each arm along its path from 0 to 1, both at the same time, from rest to rest.
void Follow(Arms& arms, const Path& path, double seconds) {
  rc::Scene scene = arms[0].robot.scene();
  const int ticks = static_cast<int>(std::lround(seconds / scene.timestep()));
  for (int i = 1; i <= ticks; ++i) {
    for (Arm& arm : arms) {
      arm.pose = path(arm, rc::MinimumJerk(i, ticks).position);
      arm.spring.SetPose(arm.robot.base_in_world().inverse() * arm.pose);
      arm.robot.Update();
    }
    if (const rc::StepResult step = scene.Step(); !step.ok()) throw rc::Error(step.message);
  }
}

// Carries the board from start to goal: each hand keeps its place on it.
void Carry(Arms& arms, const rc::Pose& start, const rc::Pose& goal, double seconds) {
  const auto path = [&](const Arm& arm, double s) {
    return start.interpolate(goal, s) * arm.grasp;
  };
  Follow(arms, path, seconds);
}

// Opens (1) or closes (0) all hands.
void Grip(Arms& arms, double opening) {
  for (Arm& arm : arms) arm.robot.gripper().SetOpening(opening);
  Follow(
      arms, [](const Arm& arm, double) { return arm.pose; }, .5);
}

void Draw(const rc::Scene& scene, const fs::path& file) {
  const auto renderer = rc::MakeRenderer({.quality = {.shadows = true, .multisamples = 4}});
  renderer->SetModel(scene.model());
  rc::RgbImage image{640, 480, std::vector<uint8_t>(640 * 480 * 3)};
  const rc::OrbitCamera camera{
      .lookat = {0, 0, .85}, .distance = 1.6, .azimuth = 110, .elevation = -25};
  renderer->Render(scene.data(), {.camera = camera, .width = 640, .height = 480},
                   {.rgb = image.pixels});
  rc::WritePng(file, image);
}

}  // namespace

int main(int argc, char** argv) try {
  const fs::path folder = argc > 1 ? argv[1] : fs::temp_directory_path() / "robocell_example_12";
  fs::create_directories(folder);
  const rc::Scene scene = Build();
  Arms arms = BothArms(scene);
  const rc::Pose start = scene.body_pose("board");
  const rc::Pose stood = start.inverse() * scene.body_pose("cube");
  const rc::Pose goal =
      Shift(0, .2, 0) * start * rc::Pose::FromRpy({0, 0, 0}, {0, 0, 20 * kDegree});
  const rc::Pose up = Shift(0, 0, .2);

  const auto come = [&](const Arm& arm, double s) {
    return arm.home.interpolate(start * arm.grasp * kBefore, s);
  };
  const auto go_down = [&](const Arm& arm, double s) {
    return start * arm.grasp * kBefore.interpolate(rc::Pose(), s);
  };
  Follow(arms, come, 1.2);
  Follow(arms, go_down, .6);
  Grip(arms, 0);
  Carry(arms, start, up * start, .8);
  Carry(arms, up * start, up * goal, 1.5);
  Draw(scene, folder / "picture.png");
  Carry(arms, up * goal, goal, .8);
  Grip(arms, 1);

  const rc::Pose board = scene.body_pose("board");
  const rc::Pose moved = start.inverse() * board;
  const rc::Pose stands = board.inverse() * scene.body_pose("cube");
  const double slip = 1000 * (stands.translation() - stood.translation()).norm();
  std::printf("the board came %.0f mm and was turned by %.0f degrees\n",
              1000 * moved.translation().norm(), moved.rpy().z() / kDegree);
  std::printf("the cube on it slid %.0f mm\n", slip);
  if (!board.is_close(goal, .02, .005)) throw rc::Error("the board is not where it should be");
  if (slip > 2) throw rc::Error("the cube slid");
  return 0;
} catch (const rc::Error& e) {
  std::fprintf(stderr, "error: %s\n", e.what());
  return 1;
}
