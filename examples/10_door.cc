// Example 10: pulls a drawer and opens a hinged door by their handles, with a compliant arm.
// Neither path has to be exact: the arm is a spring (Cartesian impedance), and the handle guides
// it. The same in Python: 10_door.py.
//
//   build/release/example_10_door [folder for picture]
#include <robocell/robocell.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <numbers>
#include <vector>

namespace fs = std::filesystem;
namespace rc = robocell;

namespace {

using std::numbers::pi;

rc::Pose Shift(double x, double y, double z) { return rc::Pose(Eigen::Vector3d(x, y, z)); }

rc::Pose Turn(double roll, double pitch, double yaw) {
  return rc::Pose::FromRpy({0, 0, 0}, {roll, pitch, yaw});
}

// The hand at a handle, in the frame of the handle's site (x points out of the cabinet): with the
// fingers on both sides of an upright bar, or of a level one.
const rc::Pose kUpright = Turn(0, -pi / 2, 0);
const rc::Pose kFromAbove = kUpright * Turn(0, 0, pi / 2) * Turn(-.5, 0, 0);
const rc::Pose kBefore = Shift(0, 0, -.1);  // 10 cm back, in the hand's own frame

// The built-in robot in front of the cabinet.
rc::Scene Build() {
  rc::SceneSpec spec{.name = "door", .timestep = 0.002, .add_floor = true, .add_skybox = true};
  spec.robots.push_back(
      {.name = "rc7", .config = rc::RobotConfig::Load(rc::assets::BuiltinRobotFile("rc7"))});
  spec.objects.push_back({.name = "cabinet",
                          .mjcf_path = "cabinet",
                          .pos = rc::Vec3{.85, -.05, 0},
                          .euler = {0, 0, 180},
                          .fixed = true});
  rc::Scene scene = rc::Scene::Build(spec);
  scene.Reset();
  return scene;
}

// The gripper at the end of a compliant arm; poses are the TCP's in the world.
class Hand {
 public:
  explicit Hand(const rc::Robot& robot) : robot_(robot), pose_(robot.tcp_in_world()) {
    spring_ = &robot_.SetController<rc::CartesianImpedanceController>("arm");
    spring_->SetStiffness({2000, 2000, 2000, 80, 80, 80});  // N/m, then Nm/rad
  }

  // Returns the target of the springs.
  const rc::Pose& pose() const { return pose_; }

  // Follows the poses path(0) to path(1), starting and ending at rest.
  void Follow(const std::function<rc::Pose(double)>& path, double seconds) {
    const int ticks = static_cast<int>(std::lround(seconds / robot_.scene().timestep()));
    for (int i = 1; i <= ticks; ++i) {
      pose_ = path(rc::MinimumJerk(i, ticks).position);
      spring_->SetPose(robot_.base_in_world().inverse() * pose_);
      robot_.Update();
      if (const rc::StepResult step = robot_.Step(); !step.ok()) throw rc::Error(step.message);
    }
  }

  // Moves there on a straight line.
  void Move(const rc::Pose& goal, double seconds) {
    const rc::Pose start = pose_;
    Follow([&](double s) { return start.interpolate(goal, s); }, seconds);
  }

  // Comes to rest.
  void Wait(double seconds) { Move(pose_, seconds); }

  // Grips a handle from in front of it.
  void Take(const rc::Pose& handle) {
    robot_.gripper().SetOpening(.4);  // open wide they would touch the panel behind the bar
    Move(handle * kBefore, 1.5);
    Move(handle, .6);
    Wait(.3);
    robot_.gripper().SetOpening(0);
    Wait(.3);
  }

  // Opens and moves back.
  void LetGo() {
    Wait(.3);
    robot_.gripper().SetOpening(.4);
    Wait(.3);
    Move(pose_ * kBefore, .6);
  }

 private:
  rc::Robot robot_;
  rc::CartesianImpedanceController* spring_;
  rc::Pose pose_;
};

void Draw(const rc::Scene& scene, const fs::path& file) {
  const auto renderer = rc::MakeRenderer({.quality = {.shadows = true, .multisamples = 4}});
  renderer->SetModel(scene.model());
  rc::RgbImage image{640, 480, std::vector<uint8_t>(640 * 480 * 3)};
  const rc::OrbitCamera camera{
      .lookat = {.4, 0, .35}, .distance = 1.75, .azimuth = -65, .elevation = -30};
  renderer->Render(scene.data(), {.camera = camera, .width = 640, .height = 480},
                   {.rgb = image.pixels});
  rc::WritePng(file, image);
}

}  // namespace

int main(int argc, char** argv) try {
  const fs::path folder = argc > 1 ? argv[1] : fs::temp_directory_path() / "robocell_example_10";
  fs::create_directories(folder);
  const rc::Scene scene = Build();
  Hand hand(rc::Robot::Of(scene, "rc7"));

  hand.Take(scene.site_pose("cabinet_drawer_handle") * kFromAbove);
  hand.Move(Shift(-.2, 0, 0) * hand.pose(), 1.5);
  hand.LetGo();
  const double drawer = scene.joint_pos("cabinet_drawer_slide");
  std::printf("the drawer is open by %.0f mm\n", 1000 * drawer);

  const rc::Pose hinge = scene.body_pose("cabinet_door");
  hand.Take(scene.site_pose("cabinet_door_handle") * kUpright);
  const rc::Pose grasp = hand.pose();
  const auto arc = [&](double s) {
    const double angle = s * (70 * (pi / 180));
    const rc::Pose bar = hinge * Turn(0, 0, angle) * hinge.inverse() * grasp;
    // The fingers can turn around the bar: the hand turns half as far as the door.
    return bar * Turn(-angle / 2, 0, 0);
  };
  hand.Follow(arc, 2.5);
  hand.LetGo();
  const double door = 180 / pi * scene.joint_pos("cabinet_door_hinge");
  std::printf("the door is open by %.0f degrees\n", door);

  if (std::abs(drawer - .2) > .01) throw rc::Error("the drawer is not where it was pulled to");
  if (std::abs(door - 70) > 3) throw rc::Error("the door is not where it was pulled to");
  Draw(scene, folder / "picture.png");
  return 0;
} catch (const rc::Error& e) {
  std::fprintf(stderr, "error: %s\n", e.what());
  return 1;
}
