// For tests only: a small episode with every kind of content.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "robocell/data/episode_writer.h"
#include "robocell/media/testing/frames.h"

namespace robocell {

struct SampleEpisode {
  EpisodeSchema schema;
  ColumnId time, qpos, pose, reward, success, phase, image_mean;
  TableId control;
  ColumnId control_time, ctrl;
  CameraId wrist;
  int width = 64;
  int height = 48;
  uint64_t seed = 0;

  explicit SampleEpisode(uint64_t its_seed = 0, bool with_camera = true, bool with_depth = false)
      : seed(its_seed) {
    time = schema.AddColumn({.name = "time", .units = "s"});
    qpos = schema.AddColumn({.name = "robots/arm/qpos",
                             .shape = {3},
                             .units = "rad",
                             .names = {"shoulder", "elbow", "wrist"},
                             .description = "joint positions before the action"});
    pose = schema.AddColumn({.name = "objects/cube/pose",
                             .type = ColumnType::kFloat32,
                             .shape = {7},
                             .units = "m, 1",
                             .frame = "world",
                             .names = {"x", "y", "z", "qx", "qy", "qz", "qw"}});
    reward = schema.AddColumn({.name = "reward", .units = "1"});
    success = schema.AddColumn({.name = "success", .type = ColumnType::kBool});
    phase = schema.AddColumn(
        {.name = "phase", .type = ColumnType::kInt32, .values = {"open", "grasp", "lift"}});
    image_mean = schema.AddColumn({.name = "image_mean", .type = ColumnType::kUint8, .shape = {2}});
    control = schema.AddTable("control");
    control_time = schema.AddColumn({.name = "time", .units = "s"}, control);
    ctrl = schema.AddColumn({.name = "ctrl", .shape = {2}}, control);
    if (with_camera) {
      const std::array<double, 9> intrinsics = {60, 0, 31.5, 0, 60, 23.5, 0, 0, 1};
      wrist = schema.AddCamera({.name = "wrist",
                                .width = width,
                                .height = height,
                                .fps_num = 500,
                                .fps_den = 33,
                                .intrinsics = intrinsics,
                                .depth = with_depth});
    }
  }

  double Qpos(int row, int joint) const {
    return std::sin(0.1 * row + joint + static_cast<double>(seed));
  }

  void PutRow(EpisodeWriter& episode, int row) const {
    episode.Put(time, 0.066 * row);
    const std::array<double, 3> q = {Qpos(row, 0), Qpos(row, 1), Qpos(row, 2)};
    episode.Put(qpos, q);
    const std::array<float, 7> p = {0.5f, 0, static_cast<float>(row), 0, 0, 0, 1};
    episode.Put(pose, p);
    episode.Put(reward, 0.01 * row);
    episode.Put(success, row > 10);
    episode.Put(phase, int32_t{row % 3});
    const std::array<uint8_t, 2> mean = {static_cast<uint8_t>(row), 7};
    episode.Put(image_mean, mean);
    episode.EndRow();
  }

  void PutControl(EpisodeWriter& episode, int tick) const {
    episode.Put(control_time, 0.002 * tick);
    const std::array<double, 2> u = {1.0 * tick, -1.0 * tick};
    episode.Put(ctrl, u);
    episode.EndRow(control);
  }

  void PutRows(EpisodeWriter& episode, int rows) const {
    for (int row = 0; row < rows; ++row) {
      PutRow(episode, row);
      if (!schema.cameras().empty()) {
        episode.WriteFrame(wrist, TestFrame(width, height, row + static_cast<int>(seed)));
        if (schema.cameras()[0].stream.depth)
          episode.WriteDepth(wrist, TestDepth(width, height, row + static_cast<int>(seed)));
      }
      for (int tick = 3 * row; tick < 3 * row + 3; ++tick) PutControl(episode, tick);
    }
  }

  EpisodeOptions Options() const {
    return {.metadata_json = R"({"seed": )" + std::to_string(seed) + R"(, "spec": "name: pick"})",
            .versions_json = R"({"mujoco": "4.0.0"})"};
  }

  std::filesystem::path Write(const std::filesystem::path& dataset, const std::string& id,
                              int rows = 20) const {
    EpisodeWriter episode(dataset, id, schema, Options());
    PutRows(episode, rows);
    episode.AddFile("scene.mjb", "binary model");
    return episode.Commit({.success = true,
                           .terminated = true,
                           .end_reason = "success",
                           .warnings = {"contact buffer full"},
                           .run_json = R"({"worker": 3})"});
  }
};

}  // namespace robocell
