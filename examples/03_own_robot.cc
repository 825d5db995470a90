// Example 3: a robot of your own: its model, ten lines of YAML, and their use. The robot is
// desk6/desk6.yaml, a six-axis arm made for this example. The example uses its forward and inverse
// kinematics, moves its gripper, and shows the error for a mistake in its file. The same in Python:
// 03_own_robot.py.
//
//   build/release/example_03_own_robot [folder for the picture]
#include <robocell/robocell.h>

#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

namespace fs = std::filesystem;
namespace rc = robocell;

namespace {

const fs::path kRobot = fs::path(EXAMPLES_DIR) / "desk6" / "desk6.yaml";
const rc::Quaternion kDown{0, 1, 0, 0};  // xyzw: the tool points down, like at home

void Require(bool holds, const char* what) {
  if (!holds) throw rc::Error(what);
}

// The robot alone on a floor, at home.
rc::Scene SceneWith(const rc::RobotConfig& config) {
  rc::SceneSpec spec{.name = "desk", .timestep = 0.002, .add_floor = true, .add_skybox = true};
  spec.robots.push_back({.name = "desk6", .config = config});
  rc::Scene scene = rc::Scene::Build(spec);
  scene.Reset();
  return scene;
}

void Draw(const rc::Scene& scene, const std::vector<rc::Marker>& markers, const fs::path& file) {
  const auto renderer = rc::MakeRenderer({.quality = {.shadows = true, .multisamples = 4}});
  renderer->SetModel(scene.model());
  rc::RgbImage image{640, 480, std::vector<uint8_t>(640 * 480 * 3)};
  const rc::OrbitCamera view{
      .lookat = {.28, 0, .28}, .distance = 1.2, .azimuth = 125, .elevation = -25};
  renderer->Render(scene.data(), {.camera = view, .width = 640, .height = 480, .markers = markers},
                   {.rgb = image.pixels});
  rc::WritePng(file, image);
}

}  // namespace

int main(int argc, char** argv) try {
  const fs::path folder = argc > 1 ? argv[1] : fs::temp_directory_path() / "robocell_example_03";
  fs::create_directories(folder);
  rc::Scene scene = SceneWith(rc::RobotConfig::Load(kRobot));
  rc::Robot robot = rc::Robot::Of(scene, "desk6");
  std::printf("%s: %d joints, reaches %.2f m\n", robot.name().c_str(), robot.n_joints(),
              robot.reach());

  // Forward kinematics: the TCP in the robot base frame. The engine must agree.
  const std::vector<double> home = robot.arm().joint_pos();
  const rc::Pose tcp = robot.chain().Fk(home);
  const rc::Pose engine = robot.base_in_world().inverse() * scene.site_pose(robot.prefix() + "tcp");
  Require(tcp.is_close(engine, 1e-8, 1e-8), "forward kinematics differ from the engine's");
  std::printf("at home the TCP is at %.3f %.3f %.3f\n", tcp.translation().x(),
              tcp.translation().y(), tcp.translation().z());

  // Inverse kinematics of many poses at once: the tool points down, on a grid in front of the
  // robot.
  std::vector<rc::Pose> poses;
  for (int i = 1; i < 8; ++i) {
    for (int j = -6; j < 7; ++j) poses.emplace_back(Eigen::Vector3d(.1 * i, .1 * j, .15), kDown);
  }
  const rc::IkBatchResult found = rc::IkBatch(robot.chain(), poses, home);
  std::printf("of %zu points %d can be reached\n", poses.size(), found.solved());
  std::vector<rc::Marker> markers;
  for (int b = 0; b < found.size; ++b) {
    if (!found.success[b]) continue;
    Require(robot.chain().Fk(found.row(b)).is_close(poses[b], 1e-5, 1e-5), "a solution is wrong");
    rc::AddFrame(markers, robot.base_in_world() * poses[b], .05);
  }

  // The gripper: 0 is closed, 1 is open, whatever the units of its motor are. Its distances were
  // measured.
  for (const double opening : {0., .5, 1.}) {
    robot.gripper().SetOpening(opening);
    for (int i = 0; i < 500; ++i) {
      robot.Update();
      Require(scene.Step().ok(), "diverged");
    }
    std::printf("opening %g: fingers %.3f m apart\n", opening, robot.gripper().inter_finger_dist());
  }

  // An error in a file contains its place and the available names.
  std::string text = rc::ReadFile(kRobot);
  const std::string right = "joints: [left, right]";
  text.replace(text.find(right), right.size(), "joints: [left, rihgt]");
  try {
    SceneWith(rc::ParseYaml<rc::RobotConfig>(text, "desk6.yaml", kRobot.parent_path()));
  } catch (const rc::SpecError& error) {
    std::printf("%s\n", error.what());
  }

  rc::AddFrame(markers, robot.base_in_world(), .05, "base");
  rc::AddFrame(markers, robot.tcp_in_world(), .05, "tcp");
  Draw(scene, markers, folder / "picture.png");
  return 0;
} catch (const rc::Error& e) {
  std::fprintf(stderr, "error: %s\n", e.what());
  return 1;
}
