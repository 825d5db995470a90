// Example 9: three ways to make an arm compliant, and its reaction to a push. Gravity compensation:
// the arm is weightless, and can be led by hand. Cartesian impedance: springs hold its tool, which
// presses with a known force. Admittance: a force-torque sensor at the wrist moves the arm. The
// same in Python: 09_compliance.py.
//
//   build/release/example_09_compliance [folder for picture]
#include <robocell/robocell.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <vector>

namespace fs = std::filesystem;
namespace rc = robocell;

namespace {

using Vector = Eigen::Vector3d;

constexpr int kWidth = 320, kHeight = 300;

void Require(bool holds, const char* what) {
  if (!holds) throw rc::Error(what);
}

// The built-in robot with a sensor between its flange and its hand, on a table.
rc::Scene Build() {
  rc::RobotConfig config = rc::RobotConfig::Load(rc::assets::BuiltinRobotFile("rc7"));
  config.gravcomp = false;  // otherwise the engine carries the arm
  config.base = {};         // it needs no pedestal
  const rc::ElementRef hand{.name = "hand"}, wrist{.name = "wrist"};
  config.edits.push_back({.body = hand, .add_site = "wrist", .pos = rc::Vec3{0, 0, 0}});
  config.edits.push_back({.site = wrist, .add_sensor = "wrist_ft_force", .type = "force"});
  config.edits.push_back({.site = wrist, .add_sensor = "wrist_ft_torque", .type = "torque"});
  config.ft_sensors.push_back({.name = "wrist_ft", .compensate_tool = true});
  rc::SceneSpec spec{
      .name = "compliance", .timestep = 0.002, .add_floor = true, .add_skybox = true};
  spec.robots.push_back({.name = "rc7",
                         .config = config,
                         .attach_to = {rc::AttachKind::kSite, "table_table_top"},
                         .pos = {-.35, 0, 0}});
  spec.objects.push_back({.name = "table", .mjcf_path = "table", .pos = rc::Vec3{0, 0, .7}});
  return rc::Scene::Build(spec);
}

// Pushes on the hand until the next call, N in the world.
void Push(const rc::Robot& robot, const Vector& force) {
  robot.scene().SetBodyWrench("hand", force, Vector::Zero());
}

// The measured force, N in the world frame.
Vector MeasuredForce(const rc::Robot& robot) {
  return robot.ft_sensor_frame("wrist_ft").rotation() * robot.ft_sensor("wrist_ft").force;
}

// Runs the simulation, and calls `each` between the robot's update and its step; returns the
// displacement, m.
Vector Run(
    rc::Robot& robot, double seconds, const std::function<void()>& each = [] {}) {
  const Vector start = robot.tcp_in_world().translation();
  const int ticks = static_cast<int>(std::lround(seconds / robot.scene().timestep()));
  for (int i = 0; i < ticks; ++i) {
    robot.Update();
    each();
    if (const rc::StepResult step = robot.Step(); !step.ok()) throw rc::Error(step.message);
  }
  return robot.tcp_in_world().translation() - start;
}

// Motors that only carry the arm: it moves where it is led, and stays where it is left.
void LeadByHand(rc::Robot& robot) {
  robot.set_ctrl_mode(rc::CtrlMode::kTorque);
  Vector last = robot.scene().body_pose("hand").translation();
  const Vector goal = last + Vector(.05, .2, .1);
  const auto carry = [&] { robot.GravityTorques(robot.jnt_trq_cmd()); };
  const auto lead = [&] {  // the arm of a person: a spring and a damper
    carry();
    const Vector here = robot.scene().body_pose("hand").translation();
    Push(robot, 200 * (goal - here) - 100 * (here - last) / robot.scene().timestep());
    last = here;
  };

  const double alone = 1000 * Run(robot, 1, carry).norm();
  const double led = 1000 * Run(robot, 4, lead).norm();
  Push(robot, Vector::Zero());
  Run(robot, 2, carry);
  const double left = 1000 * Run(robot, 1, carry).norm();
  std::printf("weightless: alone %.1f mm, led %.0f mm, left there %.1f mm\n", alone, led, left);
  Require(alone < 1 && led > 200 && left < 1, "it does not stay where it is left");
}

// Springs at the tool: the table holds it back, and they push in proportion to their displacement.
void Press(rc::Robot& robot) {
  const rc::Pose table = robot.scene().site_pose("table_table_top");
  robot.gripper().Close();
  // The TCP over the table, pointing down, in the robot base frame.
  const auto over_table = [&](double height) {
    const rc::Pose place(Vector(0, 0, height), rc::Quaternion{1, 0, 0, 0});
    return robot.base_in_world().inverse() * table * place;
  };

  robot.SetController<rc::CartesianPoseController>("arm").SetPose(over_table(.03));
  Run(robot, 2);
  auto& spring = robot.SetController<rc::CartesianImpedanceController>("arm");
  spring.SetStiffness({800, 800, 500, 40, 40, 40});  // N/m, then Nm/rad
  for (const double height : {-.01, -.03}) {
    spring.SetPose(over_table(height));
    Run(robot, 1);
    const double stretched =
        robot.tcp_in_world().translation().z() - table.translation().z() - height;
    const double force = MeasuredForce(robot).z();
    std::printf("springs: stretched %.1f mm they push with %.1f N\n", 1000 * stretched, force);
    Require(std::abs(force - 500 * stretched) < .02 * force, "the sensor disagrees");
  }
}

// Admittance control: the tool follows the measured force like a mass in oil.
void GiveWay(rc::Robot& robot) {
  auto& cartesian = robot.SetController<rc::CartesianPoseController>("arm");
  const double mass = 4, oil = 100, dt = robot.scene().timestep();  // kg, Ns/m, s
  rc::Pose goal = robot.tcp_in_world();
  Vector velocity = Vector::Zero();
  const auto follow = [&] {
    velocity = velocity + dt / mass * (MeasuredForce(robot) - oil * velocity);
    goal = rc::Pose(Vector(dt * velocity)) * goal;
    cartesian.SetPose(robot.base_in_world().inverse() * goal);
  };

  Push(robot, {0, 10, 0});
  Run(robot, .5, follow);
  const double speed = Run(robot, 1, follow).y();
  Push(robot, Vector::Zero());
  Run(robot, .5, follow);
  const double rest = std::abs(Run(robot, 1, follow).y());
  std::printf("admittance: 10 N move it with %.0f mm/s, none with %.0f mm/s\n", 1000 * speed,
              1000 * rest);
  Require(std::abs(speed - 10 / oil) < .02 * speed && rest < 1e-3, "it moves wrong");
}

rc::RgbImage Picture(const rc::Scene& scene, rc::Renderer& renderer) {
  rc::RgbImage image{kWidth, kHeight, std::vector<uint8_t>(3 * kWidth * kHeight)};
  const rc::OrbitCamera camera{
      .lookat = {-.15, .05, .95}, .distance = 1.35, .azimuth = 150, .elevation = -20};
  renderer.Render(scene.data(), {.camera = camera, .width = kWidth, .height = kHeight},
                  {.rgb = image.pixels});
  return image;
}

// Puts the picture after the motion into the n-th panel, with the one before shining through.
void Show(const rc::RgbImage& before, const rc::RgbImage& after, int n, rc::RgbImage& panels) {
  for (int row = 0; row < kHeight; ++row) {
    for (int i = 0; i < 3 * kWidth; ++i) {
      const int from = 3 * kWidth * row + i;
      panels.pixels[3 * kWidth * (3 * row + n) + i] =
          static_cast<uint8_t>((before.pixels[from] + 3 * after.pixels[from]) / 4);
    }
  }
}

}  // namespace

int main(int argc, char** argv) try {
  const fs::path folder = argc > 1 ? argv[1] : fs::temp_directory_path() / "robocell_example_09";
  fs::create_directories(folder);
  rc::Scene scene = Build();
  rc::Robot robot = rc::Robot::Of(scene, "rc7");
  const auto renderer = rc::MakeRenderer({.quality = {.shadows = true, .multisamples = 4}});
  renderer->SetModel(scene.model());
  rc::RgbImage panels{3 * kWidth, kHeight, std::vector<uint8_t>(9 * kWidth * kHeight)};
  int n = 0;
  for (void (*part)(rc::Robot&) : {LeadByHand, Press, GiveWay}) {
    scene.Reset();
    const rc::RgbImage before = Picture(scene, *renderer);
    part(robot);
    Show(before, Picture(scene, *renderer), n++, panels);
  }
  rc::WritePng(folder / "picture.png", panels);
  return 0;
} catch (const rc::Error& e) {
  std::fprintf(stderr, "error: %s\n", e.what());
  return 1;
}
