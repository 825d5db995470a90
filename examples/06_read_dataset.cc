// Example 6: read a dataset back: its columns, a replayed episode, and its path in a picture. The
// dataset is made first, as in example 2; give the folder of an existing one to read that instead.
// The same in Python: 06_read_dataset.py.
//
//   build/release/example_06_read_dataset [folder] [dataset]
#include <robocell/robocell.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace fs = std::filesystem;
namespace rc = robocell;

namespace {

using Colour = std::array<uint8_t, 3>;
constexpr std::array<Colour, 6> kColours = {
    {{40, 90, 200}, {40, 160, 220}, {250, 200, 40}, {240, 120, 30}, {220, 40, 40}, {90, 0, 90}}};

void Require(bool holds, const std::string& what) {
  if (!holds) throw rc::Error(what);
}

// One pick, seen from beside the robot.
fs::path MakeDataset(const fs::path& folder) {
  fs::remove_all(folder);
  rc::RunConfig run{.run = "example"};
  run.output = folder;
  run.robot.config = rc::RobotConfig::Load(rc::assets::BuiltinRobotFile("rc7"));
  run.start = {.base_distance = {{0.35, 0.5}}, .base_height_offset = -0.25};
  run.cameras.resolution = {320, 240};
  run.cameras.streams = {{.name = "exo", .camera = "exo_camera"}};
  rc::PrepareDataset(run);
  rc::Runner runner(run);
  for (const rc::PlanItem& item : rc::MakePlan(run)) runner.Run(item);
  return folder;
}

// Applies the recorded controls to the recorded start; returns the final error of the arm.
double Play(const rc::Episode& episode) {
  rc::Scene scene = rc::Scene::Build(rc::RecordedScene(episode));
  scene.SetState(episode.Read<double>("initial_state"));
  const std::vector<double> ctrl = episode.Read<double>("control/ctrl");
  const std::vector<double> time = episode.Read<double>("control/time");
  const size_t nu = ctrl.size() / time.size(), ticks = time.size() / episode.rows();  // per row
  const int steps = static_cast<int>(std::lround(time[1] / scene.timestep()));  // engine steps
  for (size_t tick = 0; tick < time.size() - ticks; ++tick) {
    std::copy_n(&ctrl[tick * nu], nu, scene.data()->ctrl);
    Require(scene.StepN(steps).ok(), "diverged");
  }  // the last row is the state before its action
  const std::vector<double> joints = rc::Robot::Of(scene, "rc7").arm().joint_pos();
  const std::vector<double> then =
      episode.Read<double>("robots/rc7/arm/qpos", {.first = episode.rows() - 1});
  double off = 0;
  for (size_t j = 0; j < joints.size(); ++j) off = std::max(off, std::abs(joints[j] - then[j]));
  return off;
}

// Returns the first frame of a camera with the path of the TCP, coloured by the expert's phase.
rc::RgbImage DrawPath(const rc::Episode& episode, const std::string& name) {
  const rc::CameraInfo& camera = episode.camera(name);
  rc::RgbImage image{camera.width, camera.height, {}};
  image.pixels.resize(3 * image.width * image.height);
  episode.Video(name).Read(0, image.pixels);
  using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  using RowMajor4 = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
  const auto k = episode.Read<double>("cameras/" + name + "/intrinsics");
  const auto e = episode.Read<double>("cameras/" + name + "/extrinsics", {.first = 0, .count = 1});
  const auto tcp = episode.Read<double>("robots/rc7/tcp_pose");
  const auto phase = episode.Read<int32_t>("phase");
  for (size_t row = 0; row < phase.size(); ++row) {
    const Eigen::Vector4d point(tcp[7 * row], tcp[7 * row + 1], tcp[7 * row + 2], 1);
    const Eigen::Vector3d in_camera = (Eigen::Map<const RowMajor4>(e.data()) * point).head<3>();
    const Eigen::Vector3d uv = Eigen::Map<const RowMajor3>(k.data()) * in_camera / in_camera.z();
    const auto u = std::lround(uv.x()), v = std::lround(uv.y());
    for (auto y = std::max(v - 1, 0L); y < std::min<long>(v + 2, image.height); ++y) {
      for (auto x = std::max(u - 1, 0L); x < std::min<long>(u + 2, image.width); ++x)
        std::ranges::copy(kColours[phase[row]], &image.pixels[3 * (y * image.width + x)]);
    }
  }
  return image;
}

}  // namespace

int main(int argc, char** argv) try {
  const fs::path folder = argc > 1 ? argv[1] : fs::temp_directory_path() / "robocell_example_06";
  fs::create_directories(folder);
  const rc::Dataset episodes(argc > 2 ? fs::path(argv[2]) : MakeDataset(folder / "dataset"));
  for (const rc::Episode& episode : episodes) {
    std::printf("%s: %s\n", episode.id().c_str(), episode.end_reason().c_str());
    const rc::ColumnInfo& qpos = episode.column("robots/rc7/arm/qpos");
    std::printf("  qpos: %td rows of %d joints, %s\n", static_cast<ptrdiff_t>(qpos.rows),
                static_cast<int>(qpos.spec.shape[0]), qpos.spec.units.c_str());
    const std::vector<int32_t> phase = episode.Read<int32_t>("phase");
    const std::vector<std::string>& names = episode.column("phase").spec.values;
    std::printf("  rows:");
    for (int i = 0; i < static_cast<int>(names.size()); ++i) {
      std::printf("%s %td %s", i ? "," : "", std::count(phase.begin(), phase.end(), i),
                  names[i].c_str());
    }
    std::printf("\n  lifted %.1f cm\n", 100 * episode.Read<double>("reward").back());
    Require(episode.camera("exo").frames == episode.rows(), "frame i belongs to row i");

    // Replayed by hand, and by the check that compares every row and tick.
    Require(Play(episode) < 1e-9, "it was not the same when played again");
    const rc::ReplayResult result = rc::VerifyReplay(episode);
    std::printf("  replayed: %s\n", result.ok() ? "the same" : result.Text().c_str());
    Require(result.ok(), result.Text());
  }
  rc::WritePng(folder / "picture.png", DrawPath(*episodes.begin(), "exo"));
  return 0;
} catch (const rc::Error& e) {
  std::fprintf(stderr, "error: %s\n", e.what());
  return 1;
}
