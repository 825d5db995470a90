// Example 2: generate a small pick dataset with the built-in robot, read it back, check it. The
// same in Python: 02_generate_dataset.py. On all cores and with progress: robocell generate
// demo.yaml
//
//   build/release/example_02_generate_dataset [folder]
#include <robocell/robocell.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

namespace fs = std::filesystem;
namespace rc = robocell;

namespace {

// Five frames of a video side by side.
rc::RgbImage Strip(const rc::Episode& episode, const std::string& name) {
  const rc::CameraInfo& camera = episode.camera(name);
  rc::VideoReader video = episode.Video(name);
  std::vector<uint8_t> frame(video.frame_bytes());
  rc::RgbImage strip{5 * camera.width, camera.height, {}};
  strip.pixels.resize(5 * frame.size());
  const size_t line = 3 * static_cast<size_t>(camera.width);
  for (int i = 0; i < 5; ++i) {
    video.Read(i * (camera.frames - 1) / 4, frame);
    for (int y = 0; y < camera.height; ++y)
      std::copy_n(&frame[y * line], line, &strip.pixels[(5 * y + i) * line]);
  }
  return strip;
}

}  // namespace

int main(int argc, char** argv) try {
  const fs::path folder = argc > 1 ? argv[1] : fs::temp_directory_path() / "robocell_example_02";
  rc::RunConfig run{.run = "example"};
  run.robot.config = rc::RobotConfig::Load(rc::assets::BuiltinRobotFile("rc7"));
  run.task = rc::PickTaskConfig{.objects = {"box", "mug"}};
  run.start = {.base_distance = {{0.35, 0.5}}, .base_height_offset = -0.25};
  run.cameras.resolution = {160, 120};
  run.cameras.streams = {{.name = "wrist", .camera = "wrist_camera"}};
  run.episodes_per_scene = 2;
  run.output = folder / "dataset";
  fs::remove_all(run.output);

  rc::PrepareDataset(run);
  rc::Runner runner(run);
  for (const rc::PlanItem& item : rc::MakePlan(run)) {
    const rc::ItemResult result = runner.Run(item);
    std::printf("%s: %s, attempts: %d, rows: %d\n", item.id.c_str(),
                result.success ? "success" : "no success", result.attempts, result.rows);
  }

  for (const rc::Episode& episode : rc::Dataset(run.output)) {
    const rc::CameraInfo& wrist = episode.camera("wrist");
    std::printf("%s: lifted %.3f m, %d frames\n", episode.id().c_str(),
                episode.Read<double>("reward").back(), static_cast<int>(wrist.frames));
    if (wrist.frames != episode.rows()) throw rc::Error("frame i belongs to row i");
  }
  rc::WritePng(folder / "picture.png", Strip(*rc::Dataset(run.output).begin(), "wrist"));
  const rc::VerifyResult found = rc::Verify(run.output);
  std::printf("%zu episodes, every byte as it was written: %s\n", found.good.size(),
              found.ok() ? "True" : "False");
  return found.ok() && found.good.size() == 2 ? 0 : 1;
} catch (const rc::Error& e) {
  std::fprintf(stderr, "error: %s\n", e.what());
  return 1;
}
