// Example 1: build a scene with a robot and a cube, move the arm over the cube with inverse
// kinematics, close the gripper on it, lift it, and take a picture. The same in Python:
// 01_build_and_control.py.
//
//   build/release/example_01_build_and_control [folder]
#include <robocell/robocell.h>

#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

namespace fs = std::filesystem;
namespace rc = robocell;

namespace {

// Drives the arm to a pose of the TCP (in the robot base frame) and waits for its arrival.
void MoveTo(rc::Scene& scene, rc::Robot& robot, const rc::Pose& tcp, double seconds) {
  const rc::IkResult ik = robot.Ik(tcp, {.prefer = rc::IkPrefer::kSeed});
  if (!ik.success) throw rc::Error("the pose is out of reach");
  const std::vector<double> from(robot.jnt_pos_cmd().begin(), robot.jnt_pos_cmd().end());
  const int ticks = static_cast<int>(seconds / scene.timestep());
  for (int i = 1; i <= ticks; ++i) {
    const double s = rc::MinimumJerk(i, ticks).position;
    for (int j = 0; j < robot.n_joints(); ++j)
      robot.jnt_pos_cmd()[j] = from[j] + s * (ik.q.data()[j] - from[j]);
    robot.Update();
    if (const rc::StepResult step = robot.Step(); !step.ok()) throw rc::Error(step.message);
  }
}

void Grip(rc::Robot& robot, double opening, double seconds) {
  robot.Apply({{"gripper", rc::GroupCommand::Opening(opening)}});
  for (int i = 0; i < static_cast<int>(seconds / robot.scene().timestep()); ++i) {
    robot.Update();
    if (const rc::StepResult step = robot.Step(); !step.ok()) throw rc::Error(step.message);
  }
}

}  // namespace

int main(int argc, char** argv) try {
  rc::SceneSpec spec{.name = "lift", .timestep = 0.002, .add_floor = true, .add_skybox = true};
  spec.robots.push_back(
      {.name = "arm", .config = rc::RobotConfig::Load(rc::assets::BuiltinRobotFile("rc7"))});
  spec.objects.push_back({.name = "cube",
                          .shape = rc::Shape::kBox,
                          .size = rc::Vec3{.02, .02, .02},
                          .rgba = rc::Vec4{1, .5, 0, 1},
                          .mass = .1,
                          .friction = rc::Vec3{.8, .02, .001},
                          .condim = rc::Condim::kTorsional,
                          .pos = rc::Vec3{.45, 0, .02}});
  rc::Scene scene = rc::Scene::Build(spec);
  scene.Reset();
  rc::Robot robot = rc::Robot::Of(scene, "arm");

  // A pose above the cube, tool pointing down, expressed in the robot base frame.
  const rc::Pose down({0, 0, 0}, rc::Quaternion{1, 0, 0, 0});
  const rc::Pose cube_in_robot = robot.base_in_world().inverse() * scene.body_pose("cube");
  const rc::Pose grasp = rc::Pose(cube_in_robot.translation()) * down;
  const rc::Pose above = rc::Pose(Eigen::Vector3d(0, 0, .12)) * grasp;

  Grip(robot, 1, .3);
  MoveTo(scene, robot, above, 2);
  MoveTo(scene, robot, grasp, 1);
  Grip(robot, 0, .6);
  MoveTo(scene, robot, above, 1);

  const double height = scene.body_pose("cube").translation().z();
  std::printf("the cube is %.3f m above the floor\n", height);
  if (!robot.gripper().is_grasping("cube") || height < .1) throw rc::Error("it was not lifted");

  const auto renderer = rc::MakeRenderer({.quality = {.shadows = true, .multisamples = 4}});
  renderer->SetModel(scene.model());
  rc::RgbImage image{640, 480, std::vector<uint8_t>(640 * 480 * 3)};
  const rc::OrbitCamera camera{
      .lookat = {.25, 0, .3}, .distance = 1.7, .azimuth = 130, .elevation = -20};
  renderer->Render(scene.data(), {.camera = camera, .width = 640, .height = 480},
                   {.rgb = image.pixels});
  const fs::path folder = argc > 1 ? argv[1] : fs::temp_directory_path() / "robocell_example_01";
  fs::create_directories(folder);
  rc::WritePng(folder / "picture.png", image);
  return 0;
} catch (const rc::Error& e) {
  std::fprintf(stderr, "error: %s\n", e.what());
  return 1;
}
