// Example 15: record an environment: an operator's actions become episodes of a dataset. A program
// plays the operator: it draws two circles with the tool and gives up a third one. The episodes are
// verified, read, and replayed to the bit. The same in Python: 15_record.py.
//
//   build/release/example_15_record [folder]
#include <robocell/robocell.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

namespace fs = std::filesystem;
namespace rc = robocell;

namespace {

constexpr int kSteps = 40;

// Moves the tool along a circle in the plane in front of the robot, step by step.
void DrawCircle(rc::Env& env, double radius, int steps = kSteps) {
  for (int i = 0; i < steps; ++i) {
    const double angle = 2 * M_PI * i / kSteps;
    const double way = 2 * M_PI * radius / kSteps;
    const double across = -way * std::sin(angle), up = way * std::cos(angle);
    env.Step(std::vector<double>{0, across, up, 0, 0, 0, 1, static_cast<double>(i % 2)});
  }
}

// Records two episodes that are kept, and one that is not.
std::vector<std::string> Record(const rc::EnvConfig& config, const fs::path& dataset) {
  rc::Env env(config);
  rc::EnvRecorder recorder(env, dataset, {.metadata_json = R"({"operator": "a script"})"});
  env.Reset({.seed = 1});
  DrawCircle(env, 0.10);
  env.Reset({.seed = 2});  // saves the first one
  DrawCircle(env, 0.05);
  recorder.Save({.success = true, .reason = "round enough"});
  env.Reset({.seed = 3});
  DrawCircle(env, 0.07, 5);
  recorder.Discard();
  return recorder.episodes();
}

// Returns the extent of the tool's path along an axis.
double Extent(const std::vector<double>& tquat, size_t axis) {
  double least = tquat[axis], most = tquat[axis];
  for (size_t i = axis; i < tquat.size(); i += 7) {
    least = std::min(least, tquat[i]);
    most = std::max(most, tquat[i]);
  }
  return most - least;
}

void Require(bool good, const char* what) {
  if (!good) throw rc::Error(what);
}

// Joins three frames side by side.
rc::RgbImage Frames(const rc::Episode& episode) {
  const rc::CameraInfo& camera = episode.camera("exo");
  const auto width = static_cast<size_t>(camera.width), height = static_cast<size_t>(camera.height);
  rc::RgbImage picture{static_cast<int>(3 * width), static_cast<int>(height),
                       std::vector<uint8_t>(9 * width * height)};
  std::vector<uint8_t> frame(3 * width * height);
  for (const size_t i : {0, 1, 2}) {
    episode.ReadFrame("exo", rc::ImageKind::kColour, static_cast<int64_t>(i * kSteps / 4),
                      std::span(frame));
    for (size_t row = 0; row < height; ++row)
      std::copy_n(frame.begin() + static_cast<long>(3 * width * row), 3 * width,
                  picture.pixels.begin() + static_cast<long>(3 * width * (3 * row + i)));
  }
  return picture;
}

void Run(const fs::path& folder) {
  const fs::path dataset = folder / "dataset";
  fs::create_directories(folder);
  fs::remove_all(dataset);
  rc::EnvConfig config = rc::EnvConfig::Load(rc::assets::BuiltinCellFile("rc7"));
  config.cameras.resolution = {320, 240};
  config.cameras.streams.push_back({.name = "exo", .camera = "robotrobot_exo_camera"});

  for (const std::string& name : Record(config, dataset)) {
    const rc::Episode episode = rc::Dataset(dataset).Open(name);
    const std::vector<double> tool = episode.Read<double>("observation/robot/tquat");
    std::printf("%s: %d steps, %s\n", name.c_str(), static_cast<int>(episode.rows()),
                episode.end_reason().c_str());
    std::printf("  the tool went %.2f m across and %.2f m up\n", Extent(tool, 1), Extent(tool, 2));
    Require(rc::VerifyReplay(episode, {.tolerance = 0}).ok(), "other controls, other states");
    Require(rc::ReplayActions(*rc::EnvOfEpisode(episode), episode).ok(), "other observations");
  }
  Require(rc::Verify(dataset).problems.empty(), "the dataset is damaged");
  std::printf("replayed: the same to the bit\n");
  rc::WritePng((folder / "picture.png").string(), Frames(rc::Dataset(dataset).At(0)));
}

}  // namespace

int main(int argc, char** argv) {
  const fs::path folder =
      argc > 1 ? fs::path(argv[1]) : fs::temp_directory_path() / "robocell_example_15";
  try {
    Run(folder);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
