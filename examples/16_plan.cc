// Example 16: plans motions around obstacles: to any of a set of grasps, and with a cube in the
// hand. The goal of the first motion is a region: above the cube, the fingers turned as they like.
// The second motion carries the cube around a wall, upright. Both are timed within limits of
// velocity, acceleration and jerk, and driven. The same in Python: 16_plan.py.
//
//   build/release/example_16_plan [folder for the picture]
#include <robocell/robocell.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

namespace fs = std::filesystem;
namespace rc = robocell;

namespace {

using std::numbers::pi;

const rc::Pose kDown = rc::Pose::FromRpy({0, 0, 0}, {pi, 0, 0});  // the approach axis points down
const rc::Pose kRaised(Eigen::Vector3d(0, 0, .12));
const rc::MotionLimits kLimits{.velocity = {1.5}, .acceleration = {5}, .jerk = {60}};
const Eigen::Vector3d kCube(.42, .25, .22), kPlace(.42, -.25, .22);  // m

// A box; half its lengths, and its centre.
rc::SceneObject Block(const std::string& name, const rc::Vec3& size, const rc::Vec3& pos) {
  return {.name = name,
          .shape = rc::Shape::kBox,
          .size = size,
          .rgba = rc::Vec4{.9, .5, .2, 1},
          .mass = .1,
          .friction = rc::Vec3{1, .02, .001},
          .pos = pos};
}

// The built-in robot, a cube on a table, and a wall between the cube and its place.
rc::Scene Build() {
  rc::SceneSpec spec{.name = "plan", .timestep = .002, .add_floor = true, .add_skybox = true};
  spec.robots.push_back(
      {.name = "rc7", .config = rc::RobotConfig::Load(rc::assets::BuiltinRobotFile("rc7"))});
  for (rc::SceneObject fixed :
       {Block("table", {.2, .4, .1}, {.5, 0, .1}), Block("wall", {.2, .02, .15}, {.5, 0, .35})}) {
    fixed.fixed = true;
    fixed.rgba = rc::Vec4{.5, .6, .7, 1};
    spec.objects.push_back(fixed);
  }
  spec.objects.push_back(Block("cube", {.02, .02, .02}, {kCube.x(), kCube.y(), kCube.z()}));
  rc::Scene scene = rc::Scene::Build(spec);
  scene.Reset();
  return scene;
}

void Step(rc::Robot& robot) {
  robot.Update();
  if (const rc::StepResult step = robot.Step(); !step.ok()) throw rc::Error(step.message);
}

// Lets the fingers and the arm come to rest.
void Wait(rc::Robot& robot, double seconds) {
  const auto steps = std::lround(seconds / robot.scene().timestep());
  for (int i = 0; i < steps; ++i) Step(robot);
}

// Moves the arm along a path and comes to rest.
rc::Trajectory Drive(rc::Robot& robot, const rc::MotionResult& result) {
  if (!result.success) throw rc::Error(result.message);
  rc::Trajectory motion = rc::TimePath(result.path, kLimits);
  for (const std::vector<double>& q : motion.Sample(robot.scene().timestep())) {
    robot.SetJntPosCmd(q);
    Step(robot);
  }
  Wait(robot, .3);
  return motion;
}

// Moves the TCP on a straight line.
void DriveLine(rc::Robot& robot, rc::MotionPlanner& planner, const rc::Pose& tcp) {
  planner.Update();
  Drive(robot, planner.PlanLine(planner.present(), tcp));
}

// The TCP over a place, the fingers turned as they like.
rc::MotionGoal Above(const Eigen::Vector3d& place) {
  rc::MotionGoal goal = rc::MotionGoal::Tcp(rc::Pose(place) * kRaised * kDown);
  goal.free_rotation = {0, 0, pi};
  return goal;
}

// The TCP at a place, turned as it is.
rc::Pose Lowered(const rc::Robot& robot, const Eigen::Vector3d& place) {
  return rc::Pose(place, robot.tcp_in_world().quaternion());
}

void Require(bool holds, const char* what) {
  if (!holds) throw rc::Error(what);
}

void Draw(const rc::Scene& scene, const fs::path& file) {
  const auto renderer = rc::MakeRenderer({.quality = {.shadows = true, .multisamples = 4}});
  renderer->SetModel(scene.model());
  rc::RgbImage image{640, 480, std::vector<uint8_t>(640 * 480 * 3)};
  const rc::OrbitCamera camera{
      .lookat = {.35, 0, .35}, .distance = 1.5, .azimuth = 200, .elevation = -30};
  renderer->Render(scene.data(), {.camera = camera, .width = 640, .height = 480},
                   {.rgb = image.pixels});
  rc::WritePng(file, image);
}

}  // namespace

int main(int argc, char** argv) try {
  const fs::path folder = argc > 1 ? argv[1] : fs::temp_directory_path() / "robocell_example_16";
  fs::create_directories(folder);
  rc::Scene scene = Build();
  rc::Robot robot = rc::Robot::Of(scene, "rc7");
  robot.gripper().SetOpening(1);

  rc::MotionPlanner free_hand(robot, {.clearance = .005});
  rc::MotionResult result = free_hand.Plan({Above(kCube)}, {.seed = 1});
  rc::Trajectory motion = Drive(robot, result);
  std::printf("above the cube: %zu waypoints, %.2f s\n", result.path.size(), motion.duration());
  DriveLine(robot, free_hand, Lowered(robot, kCube));
  robot.gripper().SetOpening(0);
  Wait(robot, .5);
  Require(robot.gripper().is_grasping("cube"), "the hand holds nothing");

  // Off the table: the cube may touch everything. Then it moves with the hand, and nothing but the
  // hand may touch it.
  rc::MotionPlanner touching(robot, {.allowed_contacts = {{"cube", ""}}});
  DriveLine(robot, touching, kRaised * robot.tcp_in_world());
  rc::MotionPlanner carrying(
      robot, {.clearance = .005,
              .attached = {{"cube", robot.prefix() + "hand"}},
              .keep_axis = rc::AxisConstraint{.axis_in_tcp = {0, 0, -1}, .tolerance = .25}});
  result = carrying.Plan({Above(kPlace)}, {.seed = 1});
  motion = Drive(robot, result);
  std::printf("around the wall: %zu waypoints, %.2f s\n", result.path.size(), motion.duration());
  Draw(scene, folder / "picture.png");

  DriveLine(robot, touching, Lowered(robot, kPlace));
  robot.gripper().SetOpening(1);
  Wait(robot, .5);
  const Eigen::Vector3d cube = scene.body_pose("cube").translation();
  const double off = std::hypot(cube.x() - kPlace.x(), cube.y() - kPlace.y());
  std::printf("the cube is within %.0f mm of its place\n", 10 * std::ceil(100 * off));
  Require(off < .02, "the cube is elsewhere");

  result = free_hand.Plan({rc::MotionGoal::Tcp(rc::Pose(Eigen::Vector3d(3, 0, .5)))});
  std::printf("3 m away: %s\n", rc::ToString(result.failure).c_str());
  return 0;
} catch (const rc::Error& e) {
  std::fprintf(stderr, "error: %s\n", e.what());
  return 1;
}
