// Example 13: the reach of a robot: a hundred thousand poses, solved and drawn. The arm desk6 is
// loaded from its file. In the plane through its middle, at 50 by 50 places, inverse kinematics is
// solved for 40 rotations of its tool each. The picture shows the robot from the side, and the
// share of reachable rotations at each place; darker is more. The same in Python: 13_reach.py.
//
//   build/release/example_13_reach [folder for the picture]
#include <robocell/robocell.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <vector>

namespace fs = std::filesystem;
namespace rc = robocell;

namespace {

const fs::path kRobot = fs::path(EXAMPLES_DIR) / "desk6" / "desk6.yaml";
constexpr int kRotations = 40;
const rc::ReachGrid kPlane{.lower = {-.75, 0, -.45}, .upper = {.75, 0, 1.05}, .cell = .03};
constexpr int kCellPx = 10;

void Require(bool holds, const char* what) {
  if (!holds) throw rc::Error(what);
}

// Returns the number of reachable rotations at a place.
int SolvedAt(const rc::ReachMap& map, int x, int z) {
  return static_cast<int>(std::lround(map.fraction[map.index(x, 0, z)] * kRotations));
}

// The robot from the side on the left, the map on the right.
rc::RgbImage Draw(const rc::Scene& scene, const rc::ReachMap& map) {
  const int side = map.cells[2] * kCellPx;
  const auto renderer = rc::MakeRenderer({.quality = {.shadows = true, .multisamples = 4}});
  renderer->SetModel(scene.model());
  std::vector<uint8_t> robot(3UL * side * side);
  const rc::OrbitCamera view{.lookat = {0, 0, .3}, .distance = 1.8, .azimuth = 90, .elevation = 0};
  renderer->Render(scene.data(), {.camera = view, .width = side, .height = side}, {.rgb = robot});
  const int width = side + map.cells[0] * kCellPx;
  rc::RgbImage image{width, side, std::vector<uint8_t>(3UL * width * side, 255)};
  for (int row = 0; row < side; ++row) {
    uint8_t* pixel = image.pixels.data() + 3UL * width * row;
    pixel = std::copy_n(robot.data() + 3UL * side * row, 3UL * side, pixel);
    for (int column = 0; column < map.cells[0] * kCellPx; ++column, pixel += 3) {
      const int left =
          kRotations - SolvedAt(map, column / kCellPx, map.cells[2] - 1 - row / kCellPx);
      if (left == kRotations) continue;
      pixel[0] = static_cast<uint8_t>(225 * left / kRotations + 30);
      pixel[1] = static_cast<uint8_t>(195 * left / kRotations + 60);
      pixel[2] = 160;
    }
  }
  return image;
}

}  // namespace

int main(int argc, char** argv) try {
  const fs::path folder = argc > 1 ? argv[1] : fs::temp_directory_path() / "robocell_example_13";
  fs::create_directories(folder);
  rc::SceneSpec spec{.name = "desk", .timestep = 0.002, .add_floor = true, .add_skybox = true};
  spec.robots.push_back({.name = "desk6", .config = rc::RobotConfig::Load(kRobot)});
  rc::Scene scene = rc::Scene::Build(spec);
  scene.Reset();
  const rc::Robot robot = rc::Robot::Of(scene, "desk6");

  const rc::ReachMap map =
      rc::MapReach(robot.chain(), kPlane, {.rotations = kRotations, .threads = 2});
  int solved = 0, places = 0, best_x = 0, best_z = 0;
  for (int x = 0; x < map.cells[0]; ++x) {
    for (int z = 0; z < map.cells[2]; ++z) {
      const int here = SolvedAt(map, x, z);
      solved += here;
      places += here > 0;
      if (here > SolvedAt(map, best_x, best_z)) best_x = x, best_z = z;
    }
  }
  const int cells = map.cells[0] * map.cells[2];
  const Eigen::Vector3d best = map.centre(best_x, 0, best_z);
  std::printf("%d poses, %d of them reached\n", cells * kRotations, solved);
  std::printf("%d of %d places are reached at all\n", places, cells);
  std::printf("most freely at x %.3f, z %.3f: in %d ways\n", best.x(), best.z(),
              SolvedAt(map, best_x, best_z));

  // One query as a check: the TCP at that place, any rotation.
  const rc::IkResult ik =
      robot.Ik(rc::Pose(best), {.position_only = true, .prefer = rc::IkPrefer::kAwayFromLimits});
  Require(ik.success, "a place that is reached is not reached");
  Require((robot.chain().Fk(ik.q).translation() - best).norm() < 1e-5, "a solution is wrong");

  rc::WritePng(folder / "picture.png", Draw(scene, map));
  return 0;
} catch (const rc::Error& e) {
  std::fprintf(stderr, "error: %s\n", e.what());
  return 1;
}
