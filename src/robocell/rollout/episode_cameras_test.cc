#include "robocell/rollout/episode_cameras.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "robocell/data/episode_reader.h"
#include "robocell/render/stream_camera.h"
#include "robocell/spec/run_config.h"
#include "robocell/task/start_sampler.h"
#include "robocell/testing/pick_scene.h"
#include "robocell/testing/source_dir.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

constexpr double kHalfMillimetre = 0.5e-3 + 1e-6;  // with the rounding of a float

// A start of the demo, whose wrist camera also takes depth.
class EpisodeCamerasTest : public ::testing::Test {
 protected:
  EpisodeCamerasTest() {
    run = RunConfig::Load(SourceDir() + "/examples/demo.yaml");
    run.cameras.resolution = {64, 48};
    run.cameras.streams[0].depth = true;
    Rng rng = Rng::Stream(1, "start");
    for (int attempt = 0; !start; ++attempt)
      start = std::move(StartSampler(run).Sample({0, 0, attempt}, rng).start);
    renderer = MakeRenderer();
  }

  // Records two rows, between which the arm moves.
  Episode Record() {
    EpisodeSchema schema;
    const ColumnId time = schema.AddColumn({.name = "time", .units = "s"});
    CellImages images(start->scene, run.cameras, renderer.get());
    const EpisodeCameras cameras(schema, start->scene, images.images(), {500, 33});
    EpisodeWriter writer(folder.path(), "e", schema);
    for (int row = 0; row < 2; ++row) {
      writer.Put(time, start->scene.time());
      images.Draw();
      cameras.Put(writer, images.images());
      writer.EndRow();
      if (row == 0) MoveArm();
    }
    writer.Commit({.success = true});
    return Episode(folder / "e");
  }

  void MoveArm() {
    Robot robot = Robot::Of(start->scene, "rc7");
    std::vector<double> q(robot.n_joints());
    robot.arm().GetJointPos(q);
    for (double& angle : q) angle += 0.1;
    robot.SetJointPos(q);
  }

  TempDir folder;
  RunConfig run;
  std::optional<EpisodeStart> start;
  std::unique_ptr<Renderer> renderer;
};

TEST_F(EpisodeCamerasTest, RecordedDepthMatchesTheRenderer) {
  const Episode episode = Record();
  VideoReader video = episode.DepthVideo("wrist");
  std::vector<uint16_t> recorded(64 * 48), rendered_mm(64 * 48);
  std::vector<float> rendered(64 * 48);
  video.Read(1, recorded);
  const Scene& scene = start->scene;
  renderer->SetModel(scene.model());
  renderer->Render(
      scene.data(),
      {.camera = NamedCamera(scene.model(), FindCameraName(scene, run.cameras.streams[0]), "wrist"),
       .width = 64,
       .height = 48},
      {.depth = rendered, .depth_mm = rendered_mm});
  EXPECT_EQ(recorded, rendered_mm);
  for (size_t i = 0; i < recorded.size(); ++i)
    ASSERT_LE(std::abs(recorded[i] / 1000.0 - rendered[i]), kHalfMillimetre) << i;
  const auto [nearest, farthest] = std::minmax_element(recorded.begin(), recorded.end());
  EXPECT_LT(*nearest, *farthest) << "the picture shows something";
  video.Read(0, rendered_mm);
  EXPECT_NE(recorded, rendered_mm) << "the arm has moved between the rows";
}

TEST_F(EpisodeCamerasTest, StreamsWithoutDepthHaveNone) {
  const Episode episode = Record();
  EXPECT_EQ(episode.camera("wrist").depth_file, "wrist.depth.mov");
  EXPECT_EQ(episode.camera("exo").depth_file, "");
}

TEST_F(EpisodeCamerasTest, ColourIsTheSameWithAndWithoutDepth) {
  Record();
  VideoReader with = Episode(folder / "e").Video("wrist");
  std::vector<uint8_t> rgb(with.frame_bytes()), alone(with.frame_bytes());
  with.Read(0, rgb);
  std::filesystem::remove_all(folder / "e");
  Rng rng = Rng::Stream(1, "start");
  start.reset();
  for (int attempt = 0; !start; ++attempt)
    start = std::move(StartSampler(run).Sample({0, 0, attempt}, rng).start);
  run.cameras.streams[0].depth = false;
  Record();
  Episode(folder / "e").Video("wrist").Read(0, alone);
  EXPECT_EQ(rgb, alone);
}

}  // namespace
}  // namespace robocell::internal
