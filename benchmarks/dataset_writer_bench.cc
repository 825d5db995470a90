// The cost of writing a dataset beyond encoding its images: EpisodeWriter with two cameras and the
// rows of a pick, beside bare ffmpeg processes with the same frames and options. The frames are
// converted to YUV on both sides, as H.264 needs them. Row P14 of RESULTS.md.
//
// The frames of a swinging arm are rendered before. Each iteration is one episode, from opening to
// the commit. The bare encoders' files must equal the episode's videos to the byte, otherwise the
// row is an error.
//
//   build/release/dataset_writer_bench [ROBOT.yaml ...]   default: the built-in rc7
//   build/release/dataset_writer_bench --frames FILE ROBOT.yaml
//
// The second form writes the raw frames for peers in other programs, and prints the numbers of rows
// and cameras, width and height.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "bench.h"
#include "robocell/media/child_process.h"
#include "robocell/media/video_writer.h"
#include "robocell/media/yuv420.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;

constexpr int kRows = 90;  // of 66 ms, as a pick has
constexpr int kWidth = 640, kHeight = 480;
constexpr int kCameras = 2;
constexpr int kTicks = 33;       // per row
constexpr int kColumns = 30;     // of a pick's state, actions and poses
constexpr int kColumnWidth = 7;  // joints, or a pose

using Frames = std::vector<std::vector<uint8_t>>;  // camera by camera in each row

Frames FramesOf(const std::string& robot_file) {
  Scene scene = bench::SceneWith(RobotConfig::Load(robot_file));
  Robot robot = Robot::Of(scene, "robot");
  scene.Reset();
  const std::vector<double> home(robot.jnt_pos_cmd().begin(), robot.jnt_pos_cmd().end());
  const std::vector<std::string> cameras = scene.camera_names();
  if (cameras.size() < kCameras) throw Error(robot_file + ": the robot has too few cameras");
  const std::unique_ptr<Renderer> renderer = MakeRenderer();
  renderer->SetModel(scene.model());
  Frames frames;
  for (int row = 0; row < kRows; ++row) {
    for (int c = 0; c < kCameras; ++c) {
      frames.emplace_back(3 * kWidth * kHeight);
      renderer->Render(scene.data(),
                       {.camera = NamedCamera(scene.model(), cameras[c], robot_file),
                        .width = kWidth,
                        .height = kHeight},
                       {.rgb = frames.back()});
    }
    for (size_t j = 0; j < home.size(); ++j)
      robot.jnt_pos_cmd()[j] = home[j] + 0.4 * std::sin(2 * M_PI * row / kRows);
    for (int tick = 0; tick < kTicks; ++tick) {
      robot.Update();
      if (!robot.Step().ok()) throw Error(robot_file + ": the arm diverged");
    }
  }
  return frames;
}

// Returns the command of the encoder of such a video, without the output at its end. An encoder that
// is forked from a waiting ffmpeg has that one's command, so this one is started by itself.
std::vector<std::string> EncoderCommand(const fs::path& scratch) {
  setenv("ROBOCELL_WARM_FFMPEG", "0", 1);
  const VideoWriter video(scratch, {.width = kWidth, .height = kHeight});
  const fs::path source = fs::path("/proc") / std::to_string(video.encoder_pid()) / "cmdline";
  std::string text;
  while (text.empty()) text = ReadFile(source);  // it appears a moment after the process
  std::vector<std::string> words;
  for (size_t begin = 0; begin < text.size(); begin += words.back().size() + 1)
    words.emplace_back(text.c_str() + begin);
  words.pop_back();
  unsetenv("ROBOCELL_WARM_FFMPEG");
  return words;
}

class Writing {
 public:
  explicit Writing(const std::string& robot_file) : frames_(FramesOf(robot_file)) {
    for (int c = 0; c < kCameras; ++c) {
      cameras_.push_back(schema_.AddCamera({.name = Name(c), .width = kWidth, .height = kHeight}));
    }
    for (int i = 0; i < kColumns; ++i) {
      columns_.push_back(
          schema_.AddColumn({.name = "column_" + std::to_string(i), .shape = {kColumnWidth}}));
    }
    control_ = schema_.AddTable("control");
    ctrl_ = schema_.AddColumn({.name = "ctrl", .shape = {kColumnWidth}}, control_);
    command_ = EncoderCommand(folder_ / "command.mp4");
    WriteEpisode();
    for (int c = 0; c < kCameras; ++c) videos_.push_back(ReadFile(folder_ / "episode" / File(c)));
  }
  void Clear() { folder_.Clear(); }
  void WriteEpisode() {
    EpisodeWriter episode(folder_ / ".", "episode", schema_);
    std::vector<double> values(kColumnWidth);
    for (int row = 0; row < kRows; ++row) {
      for (const ColumnId column : columns_) episode.Put(column, Noise(values));
      for (int c = 0; c < kCameras; ++c)
        episode.WriteFrame(cameras_[c], frames_[row * kCameras + c]);
      for (int tick = 0; tick < kTicks; ++tick) {
        episode.Put(ctrl_, Noise(values));
        episode.EndRow(control_);
      }
      episode.EndRow();
    }
    episode.Commit({.success = true});
  }
  void EncodeOnly() {
    std::vector<std::unique_ptr<internal::ChildProcess>> encoders;
    for (int c = 0; c < kCameras; ++c) {
      std::vector<std::string> command = command_;
      command.push_back("file:" + (folder_ / File(c)).string());
      encoders.push_back(std::make_unique<internal::ChildProcess>(
          command, internal::ChildProcessOptions{.pipe_stdin = true}));
    }
    for (size_t i = 0; i < frames_.size(); ++i)
      encoders[i % kCameras]->Write(converter_(frames_[i]));
    for (const auto& encoder : encoders) encoder->CloseStdin();
    for (const auto& encoder : encoders) encoder->Wait();
  }
  std::string Problem(const fs::path& below) const {
    for (int c = 0; c < kCameras; ++c) {
      const fs::path file = folder_ / (below / File(c));
      if (!fs::exists(file) || ReadFile(file) != videos_[c])
        return file.string() + " is not the episode's video";
    }
    return "";
  }

 private:
  static std::string Name(int camera) { return "camera_" + std::to_string(camera); }
  static std::string File(int camera) { return Name(camera) + ".mp4"; }
  // Numbers that do not compress, like measurements.
  std::span<const double> Noise(std::vector<double>& values) {
    for (double& value : values) value = rng_.Uniform(-1, 1);
    return values;
  }

  Frames frames_;
  internal::Yuv420Converter converter_{kWidth, kHeight};
  bench::Folder folder_;
  EpisodeSchema schema_;
  std::vector<CameraId> cameras_;
  std::vector<ColumnId> columns_;
  TableId control_;
  ColumnId ctrl_;
  std::vector<std::string> command_;
  std::vector<std::string> videos_;
  Rng rng_ = Rng::Stream(0, "bench");
};

void Register(const std::string& file) {
  const auto it = std::make_shared<Writing>(file);
  const auto add = [&](const std::string& side, auto run, const std::string& below) {
    bench::Add({.row = RobotConfig::Load(file).name,
                .side = side,
                .count = kRows * kCameras,
                .prepare = [=] { it->Clear(); },
                .run = [=] { run(*it); },
                .problem = [=] { return it->Problem(below); }});
  };
  add(
      "writer", [](Writing& w) { w.WriteEpisode(); }, "episode");
  add(
      "ffmpeg", [](Writing& w) { w.EncodeOnly(); }, "");
}

int WriteFrames(const std::string& path, const std::string& robot_file) {
  try {
    std::ofstream file(path, std::ios::binary);
    for (const std::vector<uint8_t>& frame : FramesOf(robot_file))
      file.write(reinterpret_cast<const char*>(frame.data()),
                 static_cast<std::streamsize>(frame.size()));
    if (!file.flush()) throw Error("cannot write '" + path + "'");
    std::printf("%d %d %d %d\n", kRows, kCameras, kWidth, kHeight);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 2;
  }
}

}  // namespace
}  // namespace robocell

int main(int argc, char** argv) {
  if (argc == 4 && std::string_view(argv[1]) == "--frames")
    return robocell::WriteFrames(argv[2], argv[3]);
  return robocell::bench::Main(argc, argv, robocell::Register,
                               robocell::assets::BuiltinRobotFile("rc7"));
}
