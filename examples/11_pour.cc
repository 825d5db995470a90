// Example 11: pours a bottle into a bowl, and puts the bottle back. The plan has the place of the
// bottle's mouth, and the tilt of the bottle about it; the pose of the hand follows from its grasp
// of the bottle. The same in Python: 11_pour.py.
//
//   build/release/example_11_pour [folder for picture]
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

constexpr double kDegree = std::numbers::pi / 180;  // rad
constexpr int kBeads = 12;

rc::Pose Shift(double x, double y, double z) { return rc::Pose(Eigen::Vector3d(x, y, z)); }

rc::Pose Turn(double roll, double pitch, double yaw) {
  return rc::Pose::FromRpy({0, 0, 0}, {roll, pitch, yaw});
}

// The pose of the hand on the bottle: from behind, level.
const rc::Pose kGrasp = Turn(0, -std::numbers::pi / 2, std::numbers::pi);
const rc::Pose kBack = Shift(0, 0, -.12);  // in the hand's own frame
const rc::Pose kUp = Shift(0, 0, .2);

rc::SceneObject Bead(int i) {
  constexpr double kPlaces[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  const double* place = kPlaces[i % 4];
  const int layer = i / 4;
  return {.name = "bead" + std::to_string(i),
          .shape = rc::Shape::kSphere,
          .size = rc::Vec3{.006, 0, 0},
          .rgba = rc::Vec4{.95, .7, .2, 1},
          .mass = .002,
          .friction = rc::Vec3{.3, .001, .0001},
          .pos = rc::Vec3{.12 + .012 * place[0], -.12 + .012 * place[1], .72 + .012 * layer}};
}

// The built-in robot on a table, a bottle with beads in it, and a bowl.
rc::Scene Build() {
  rc::SceneSpec spec{.name = "pour", .timestep = 0.002, .add_floor = true, .add_skybox = true};
  rc::RobotConfig config = rc::RobotConfig::Load(rc::assets::BuiltinRobotFile("rc7"));
  config.base = {};                                        // it needs no pedestal
  config.home["arm"] = {0, .755, 0, 1.892, 0, -1.076, 0};  // keeps the hand level
  spec.robots.push_back({.name = "rc7", .config = config, .pos = {-.45, 0, .7}});
  spec.objects.push_back({.name = "table", .mjcf_path = "table", .pos = rc::Vec3{0, 0, .7}});
  spec.objects.push_back({.name = "bottle",
                          .mjcf_path = "open_bottle",
                          .pos = rc::Vec3{.12, -.12, .775},
                          .fixed = false});
  spec.objects.push_back(
      {.name = "bowl", .mjcf_path = "receiver", .pos = rc::Vec3{.12, .12, .74}, .fixed = true});
  for (int i = 0; i < kBeads; ++i) spec.objects.push_back(Bead(i));
  rc::Scene scene = rc::Scene::Build(spec);
  scene.Reset();
  return scene;
}

// Counts the beads within 60 mm of the vessel's centre.
int Count(const rc::Scene& scene, const std::string& vessel) {
  const Eigen::Vector3d middle = scene.body_pose(vessel).translation();
  int n = 0;
  for (int i = 0; i < kBeads; ++i)
    n += (scene.body_pose("bead" + std::to_string(i)).translation() - middle).norm() < .06;
  return n;
}

void Draw(const rc::Scene& scene, const fs::path& file) {
  const auto renderer = rc::MakeRenderer({.quality = {.shadows = true, .multisamples = 4}});
  renderer->SetModel(scene.model());
  rc::RgbImage image{640, 480, std::vector<uint8_t>(640 * 480 * 3)};
  const rc::OrbitCamera camera{
      .lookat = {-.05, .05, .88}, .distance = 1, .azimuth = 150, .elevation = -42};
  renderer->Render(scene.data(), {.camera = camera, .width = 640, .height = 480},
                   {.rgb = image.pixels});
  rc::WritePng(file, image);
}

}  // namespace

int main(int argc, char** argv) try {
  const fs::path folder = argc > 1 ? argv[1] : fs::temp_directory_path() / "robocell_example_11";
  fs::create_directories(folder);
  const rc::Scene scene = Build();
  rc::Robot robot = rc::Robot::Of(scene, "rc7");
  auto& arm = robot.SetController<rc::CartesianPoseController>("arm");
  arm.SetMaxSpeeds(.3, 1.5);  // m/s, rad/s
  // Moves straight towards a pose of the hand in the world, for the given time.
  const auto move = [&](const rc::Pose& hand, double seconds) {
    arm.SetPose(robot.base_in_world().inverse() * hand);
    const int ticks = static_cast<int>(std::lround(seconds / scene.timestep()));
    for (int i = 0; i < ticks; ++i) {
      robot.Update();
      if (const rc::StepResult step = robot.Step(); !step.ok()) throw rc::Error(step.message);
    }
  };

  const rc::Pose stand = scene.body_pose("bottle_open_bottle");
  const rc::Pose mouth = stand.inverse() * scene.site_pose("bottle_mouth");
  const rc::Pose over_bowl = Shift(0, -.03, .1) * scene.body_pose("bowl_receiver");
  const int before = Count(scene, "bottle_open_bottle");

  move(stand * kGrasp * kBack, 2);
  move(stand * kGrasp, .8);
  robot.gripper().SetOpening(0);
  move(stand * kGrasp, .4);
  move(kUp * stand * kGrasp, 1);
  const auto hand_for = [&](int degrees) {
    return over_bowl * Turn(-degrees * kDegree, 0, 0) * mouth.inverse() * kGrasp;
  };
  move(hand_for(70), 1.5);
  for (int degrees = 71; degrees <= 130; ++degrees) move(hand_for(degrees), .024);
  Draw(scene, folder / "picture.png");
  move(hand_for(130), .5);
  move(kUp * stand * kGrasp, 2);
  move(stand * kGrasp, 1);
  robot.gripper().SetOpening(1);
  move(stand * kGrasp, .4);

  const int poured = Count(scene, "bowl_receiver");
  std::printf("%d beads were in the bottle, %d are in the bowl\n", before, poured);
  if (before != kBeads || poured != kBeads) throw rc::Error("beads were spilt");
  if (!scene.body_pose("bottle_open_bottle").is_close(stand, .1, .01))
    throw rc::Error("the bottle is not back in its place");
  return 0;
} catch (const rc::Error& e) {
  std::fprintf(stderr, "error: %s\n", e.what());
  return 1;
}
