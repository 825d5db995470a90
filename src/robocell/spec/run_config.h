// RunConfig: what to generate. The run file, the command line's --set paths and the Python object
// have these fields.
//
//   run: xarm7_pick
//   robot: xarm7.yaml
//   task: {kind: pick, base_distance: [0.15, 0.6]}
//   scenes: {source: tabletop}
//   cameras: {resolution: [624, 352], streams: [{name: wrist, camera: wrist_camera}]}
//   episodes: 20
//   output: experiment_output/xarm7_pick
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "robocell/spec/camera_spec.h"
#include "robocell/spec/locations.h"
#include "robocell/spec/pick_task_config.h"
#include "robocell/spec/rates.h"
#include "robocell/spec/robot_config.h"
#include "robocell/spec/sim_options.h"
#include "robocell/spec/task_spec.h"

namespace robocell {

enum class SceneSourceKind { kTabletop, kFiles };
template <>
struct EnumNames<SceneSourceKind> {
  static constexpr std::array kNames = {std::pair{SceneSourceKind::kTabletop, "tabletop"},
                                        std::pair{SceneSourceKind::kFiles, "files"}};
};

enum class Keep { kSuccesses, kFirst, kAll };
template <>
struct EnumNames<Keep> {
  static constexpr std::array kNames = {std::pair{Keep::kSuccesses, "successes"},
                                        std::pair{Keep::kFirst, "first"},
                                        std::pair{Keep::kAll, "all"}};
};

// Whole numbers; in YAML a list or a range `0..3` (both ends included).
struct IndexList {
  std::vector<int> values;

  size_t size() const { return values.size(); }
  bool empty() const { return values.empty(); }
  bool operator==(const IndexList&) const = default;
};

// A robot given by file or in place. `file` is remembered for messages; `config` is what counts.
struct RobotSource {
  std::string file = {};
  RobotConfig config = {};

  bool operator==(const RobotSource& other) const { return config == other.config; }
};

struct SceneSource {
  std::optional<SceneSourceKind> source = {};
  IndexList houses = {};
  std::vector<std::string> files = {};
  std::optional<std::string> root = {};

  static constexpr const char* kTypeName = "SceneSource";
  template <class V>
  static void Fields(V&& v) {
    v("source", &SceneSource::source,
      "tabletop or files; unset: files when `files` are given, else tabletop.");
    v("houses", &SceneSource::houses,
      "Which scenes of the source: a list or 0..3; the first one unless set.");
    v("files", &SceneSource::files, "The MJCF files, with `source: files`.");
    v("root", &SceneSource::root, "Folder the files are in.");
  }
  SceneSourceKind kind() const;
  // Number of scenes that episodes are made in.
  size_t count() const;
  void Validate(Problems& problems) const;
};

struct RunConfig {
  std::string run = {};
  RobotSource robot = {};
  TaskSpec task = {};
  std::string expert = {};
  SceneSource scenes = {};
  int episodes_per_scene = 1;
  CameraSystemConfig cameras = {};
  NameList features = {};
  Rates rates = {};
  SimOptions options = {};
  Keep keep = Keep::kSuccesses;
  int max_attempts = 20;
  std::optional<int> episodes = {};
  int workers = 1;
  int64_t seed = 0;
  std::string output = {};
  std::vector<std::string> imports = {};
  // Folder of the run file, and where each value stood in it; not fields.
  std::string source_dir = {};
  Locations locations = {};

  static constexpr const char* kTypeName = "RunConfig";
  template <class V>
  static void Fields(V&& v) {
    v("run", &RunConfig::run, "Name of the run.");
    v("robot", &RunConfig::robot,
      "Robot file (relative to this file), or the robot's fields in place.");
    v("task", &RunConfig::task, "What the robot does: the kind of task and its fields.");
    v("expert", &RunConfig::expert,
      "Who acts: a registered kind of expert, or `module:Class` of a policy in Python; the task's "
      "own expert unless set.");
    v("scenes", &RunConfig::scenes, "Where the task takes place.");
    v("episodes_per_scene", &RunConfig::episodes_per_scene, "Episodes made in each scene.",
      Bound::kPositive);
    v("cameras", &RunConfig::cameras, "Image size and streams.");
    v("features", &RunConfig::features,
      "Registered features of your own that are observed and recorded beside what is built in.");
    v("rates", &RunConfig::rates, "Times of engine, control and policy.");
    v("options", &RunConfig::options, "Solver options.");
    v("keep", &RunConfig::keep,
      "successes; first (of each episode the first rollout, whatever came of it: for evaluation); "
      "or "
      "all (failures are kept and labelled).");
    v("max_attempts", &RunConfig::max_attempts, "An episode is given up after this many tries.",
      Bound::kPositive);
    v("episodes", &RunConfig::episodes,
      "How many in all; the scenes take turns. Default: episodes_per_scene for each.",
      Bound::kPositive);
    v("workers", &RunConfig::workers, "Worker processes.", Bound::kPositive);
    v("seed", &RunConfig::seed, "Seed of the run: all its random numbers follow from this one.",
      Bound::kNonNegative);
    v("output", &RunConfig::output,
      "Folder of the dataset; a relative one starts at the working folder.");
    v("imports", &RunConfig::imports,
      "Python modules that register this run's task or expert, by name or file; file names are "
      "relative to this file. They are imported when the run is started.");
  }
  void Validate(Problems& problems) const;

  // Reads a run file and the robot file it names. SpecError lists all problems with
  // file:line:column.
  static RunConfig Load(const std::string& path);
};

// What `imports` of a run file names, before the rest of it can be read. Nothing of a file that
// cannot be read: Load says what is wrong with it.
std::vector<std::string> ImportsOfRunFile(const std::string& path);

}  // namespace robocell
