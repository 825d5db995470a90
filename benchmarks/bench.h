// The common part of the benchmark programs, beside the sides of a row (sides.h).
#pragma once

#include <robocell/robocell.h>

#include <filesystem>
#include <system_error>

#include "sides.h"

namespace robocell::bench {

// A folder for a benchmark's output, removed at the end.
class Folder {
 public:
  Folder() : path_(MakeTempDirectory(std::filesystem::temp_directory_path(), "robocell_bench")) {}
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::filesystem::path operator/(const std::filesystem::path& name) const { return path_ / name; }
  void Clear() {
    for (const auto& entry : std::filesystem::directory_iterator(path_))
      std::filesystem::remove_all(entry);
  }

 private:
  std::filesystem::path path_;
};

// An empty world with one robot, "robot".
inline Scene SceneWith(const RobotConfig& robot) {
  SceneSpec spec{.name = "bench", .timestep = 0.002, .add_floor = true, .add_skybox = false};
  spec.robots.push_back({.name = "robot", .config = robot});
  return Scene::Build(spec);
}

}  // namespace robocell::bench
