// Example 7: a force-torque sensor at the wrist weighs the object in the gripper. The same in
// Python: 07_weigh.py.
//
//   build/release/example_07_weigh [folder]
#include <robocell/robocell.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

namespace fs = std::filesystem;
namespace rc = robocell;

namespace {

struct Cube {
  std::string name;
  double mass;  // kg
  double y;     // metres
  rc::Vec4 rgba;
};
const std::vector<Cube> kCubes = {{"red", .05, -.12, {.85, .25, .18, 1}},
                                  {"yellow", .12, 0, {.95, .7, .2, 1}},
                                  {"blue", .3, .12, {.16, .42, .75, 1}}};

// The built-in robot with a sensor between its flange and its hand.
rc::RobotConfig Scale() {
  rc::RobotConfig config = rc::RobotConfig::Load(rc::assets::BuiltinRobotFile("rc7"));
  const rc::ElementRef hand{.name = "hand"}, wrist{.name = "wrist"};
  config.edits.push_back({.body = hand, .add_site = "wrist", .pos = rc::Vec3{0, 0, 0}});
  config.edits.push_back({.site = wrist, .add_sensor = "wrist_ft_force", .type = "force"});
  config.edits.push_back({.site = wrist, .add_sensor = "wrist_ft_torque", .type = "torque"});
  // Without the hand's own weight, only the weight of its object remains.
  config.ft_sensors.push_back({.name = "wrist_ft", .compensate_tool = true});
  return config;
}

// The robot and three cubes of one size.
rc::Scene Cell() {
  rc::SceneSpec spec{.name = "weigh", .timestep = 0.002, .add_floor = true, .add_skybox = true};
  spec.robots.push_back({.name = "arm", .config = Scale()});
  for (const Cube& cube : kCubes) {
    spec.objects.push_back({.name = cube.name,
                            .shape = rc::Shape::kBox,
                            .size = rc::Vec3{.02, .02, .02},
                            .rgba = cube.rgba,
                            .mass = cube.mass,
                            .friction = rc::Vec3{1, .02, .001},
                            .condim = rc::Condim::kTorsional,
                            .pos = rc::Vec3{.45, cube.y, .02}});
  }
  rc::Scene scene = rc::Scene::Build(spec);
  scene.Reset();
  return scene;
}

void Tick(rc::Robot& robot) {
  robot.Update();
  if (const rc::StepResult step = robot.Step(); !step.ok()) throw rc::Error(step.message);
}

// Waits for simulated time.
void Wait(rc::Robot& robot, double seconds) {
  const int ticks = static_cast<int>(std::lround(seconds / robot.scene().timestep()));
  for (int i = 0; i < ticks; ++i) Tick(robot);
}

void Grip(rc::Robot& robot, double opening) {
  robot.Apply({{"gripper", rc::GroupCommand::Opening(opening)}});
}

// Drives the TCP, pointing down, to a place in the world along a smooth joint path.
void MoveTo(rc::Robot& robot, const Eigen::Vector3d& position, double seconds) {
  const rc::Pose down(position, rc::Quaternion{1, 0, 0, 0});
  const rc::IkResult ik =
      robot.Ik(robot.base_in_world().inverse() * down, {.prefer = rc::IkPrefer::kSeed});
  if (!ik.success) throw rc::Error("the place is out of reach");
  const std::vector<double> from(robot.jnt_pos_cmd().begin(), robot.jnt_pos_cmd().end());
  const int ticks = static_cast<int>(std::lround(seconds / robot.scene().timestep()));
  for (int i = 1; i <= ticks; ++i) {
    const double s = rc::MinimumJerk(i, ticks).position;
    for (int j = 0; j < robot.n_joints(); ++j)
      robot.jnt_pos_cmd()[j] = from[j] + s * (ik.q.data()[j] - from[j]);
    Tick(robot);
  }
}

// Returns the mass that hangs from the sensor, kg: the mean over half a second at rest.
double Weigh(rc::Robot& robot) {
  Wait(robot, .5);
  constexpr int kReadings = 250;
  double sum = 0;
  for (int i = 0; i < kReadings; ++i) {
    robot.Update();
    const Eigen::Vector3d load = robot.ft_sensor("wrist_ft").force;
    sum -= (robot.ft_sensor_frame("wrist_ft").rotation() * load).z();
    if (const rc::StepResult step = robot.Step(); !step.ok()) throw rc::Error(step.message);
  }
  return sum / kReadings / 9.81;
}

void Draw(const rc::Scene& scene, const fs::path& file) {
  const auto renderer = rc::MakeRenderer({.quality = {.shadows = true, .multisamples = 4}});
  renderer->SetModel(scene.model());
  rc::RgbImage image{640, 480, std::vector<uint8_t>(640 * 480 * 3)};
  const rc::OrbitCamera camera{
      .lookat = {.3, 0, .25}, .distance = 1.5, .azimuth = 150, .elevation = -20};
  renderer->Render(scene.data(), {.camera = camera, .width = 640, .height = 480},
                   {.rgb = image.pixels});
  rc::WritePng(file, image);
}

}  // namespace

int main(int argc, char** argv) try {
  const fs::path folder = argc > 1 ? argv[1] : fs::temp_directory_path() / "robocell_example_07";
  fs::create_directories(folder);
  rc::Scene scene = Cell();
  rc::Robot robot = rc::Robot::Of(scene, "arm");
  for (const Cube& cube : kCubes) {
    const Eigen::Vector3d place = scene.body_pose(cube.name).translation();
    const Eigen::Vector3d above = place + Eigen::Vector3d(0, 0, .12);
    Grip(robot, 1);
    MoveTo(robot, above, 1.5);
    MoveTo(robot, place, .8);
    Grip(robot, 0);
    Wait(robot, .5);
    MoveTo(robot, above, .8);
    const double measured = Weigh(robot);
    std::printf("the %s cube weighs %.0f g\n", cube.name.c_str(), 1000 * measured);
    if (std::abs(measured - cube.mass) > .01 * cube.mass) throw rc::Error("it weighs wrong");
    if (cube.name != "blue") MoveTo(robot, place, .8);
  }
  Draw(scene, folder / "picture.png");
  return 0;
} catch (const rc::Error& e) {
  std::fprintf(stderr, "error: %s\n", e.what());
  return 1;
}
