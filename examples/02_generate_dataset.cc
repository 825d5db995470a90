// Example 2: generate a small pick dataset with the built-in robot, read it back, check it. The
// same in Python: 02_generate_dataset.py. On all cores and with progress: robocell generate
// demo.yaml
//
//   build/release/example_02_generate_dataset [folder]
#include <robocell/robocell.h>

#include <cstdio>
#include <filesystem>
#include <string>

namespace rc = robocell;

int main(int argc, char** argv) try {
  const std::string folder =
      argc > 1 ? argv[1]
               : (std::filesystem::temp_directory_path() / "robocell_example_02").string();
  std::filesystem::remove_all(folder);

  rc::RunConfig run{.run = "example"};
  run.robot.config = rc::RobotConfig::Load(rc::assets::BuiltinRobotFile("rc7"));
  run.task = {.base_distance = {0.35, 0.5}, .base_height_offset = -0.25, .objects = {"box", "mug"}};
  run.cameras.resolution = {160, 120};
  run.cameras.streams = {{.name = "wrist", .camera = "wrist_camera"}};
  run.episodes_per_scene = 2;
  run.output = folder;

  rc::PrepareDataset(run);
  rc::Runner runner(run);
  for (const rc::PlanItem& item : rc::MakePlan(run)) {
    const rc::EpisodeReport report = runner.Run(item);
    std::printf("%s: %s after %d attempts, %d rows\n", item.id.c_str(),
                report.success ? "success" : "no success", report.attempts, report.rows);
  }

  for (const rc::Episode& episode : rc::Dataset(folder)) {
    const std::vector<double> reward = episode.Read<double>("reward");
    std::printf("%s: lifted %.3f m, %lld frames from the wrist\n", episode.id().c_str(),
                reward.back(), static_cast<long long>(episode.camera("wrist").frames));
  }
  const rc::VerifyReport report = rc::Verify(folder);
  std::printf("%s", report.Text().c_str());
  return report.ok() && report.good.size() == 2 ? 0 : 1;
} catch (const rc::Error& e) {
  std::fprintf(stderr, "error: %s\n", e.what());
  return 2;
}
