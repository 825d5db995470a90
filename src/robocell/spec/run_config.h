// RunConfig: the dataset to generate. The run file, the command line's --set paths and the Python
// object have the same fields.
//
//   run: xarm7_pick
//   robot: xarm7.yaml
//   task: {kind: pick, objects: [box, mug]}
//   start: {base_distance: [0.15, 0.6]}
//   scenes: {source: tabletop}
//   cameras: {resolution: [624, 352], streams: [{name: wrist, camera: wrist_camera}]}
//   episodes: 20
//   output: experiment_output/xarm7_pick
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "robocell/spec/action_noise_config.h"
#include "robocell/spec/augment_config.h"
#include "robocell/spec/camera_spec.h"
#include "robocell/spec/containers.h"
#include "robocell/spec/locations.h"
#include "robocell/spec/randomize_config.h"
#include "robocell/spec/rates.h"
#include "robocell/spec/robot_config.h"
#include "robocell/spec/scene_source_spec.h"
#include "robocell/spec/sim_options.h"
#include "robocell/spec/start_config.h"
#include "robocell/spec/task_spec.h"

namespace robocell {

enum class Keep { kSuccesses, kFirst, kAll };
template <>
struct EnumNames<Keep> {
  static constexpr std::array kNames = {std::pair{Keep::kSuccesses, "successes"},
                                        std::pair{Keep::kFirst, "first"},
                                        std::pair{Keep::kAll, "all"}};
};

// The rollouts whose images are drawn.
enum class RenderWhen { kAlways, kKept };
template <>
struct EnumNames<RenderWhen> {
  static constexpr std::array kNames = {std::pair{RenderWhen::kAlways, "always"},
                                        std::pair{RenderWhen::kKept, "kept"}};
};

// A robot given by a file or inline. Only `config` counts; `file` is kept for messages.
struct RobotSource {
  std::string file = {};
  RobotConfig config = {};

  bool operator==(const RobotSource& other) const { return config == other.config; }
};

struct RunConfig {
  std::string run = {};
  RobotSource robot = {};
  TaskSpec task = {};
  StartConfig start = {};
  Maybe<RandomizeConfig> randomize = {};
  std::string sampler = {};
  std::string expert = {};
  Maybe<AugmentConfig> augment = {};
  Maybe<ActionNoiseConfig> noise = {};
  SceneSourceSpec scenes = {};
  int episodes_per_scene = 1;
  CameraSystemConfig cameras = {};
  NameList features = {};
  Rates rates = {};
  SimOptions options = {};
  Keep keep = Keep::kSuccesses;
  std::optional<RenderWhen> render = {};
  int max_attempts = 20;
  std::optional<int> episodes = {};
  int workers = 1;
  int64_t seed = 0;
  std::string output = {};
  std::vector<std::string> imports = {};
  // Folder of the run file, and the locations of its values; not fields.
  std::string source_dir = {};
  Locations locations = {};

  static constexpr const char* kTypeName = "RunConfig";
  template <class V>
  static void Fields(V&& v) {
    v("run", &RunConfig::run, "Name of the run.");
    v("robot", &RunConfig::robot, "Robot file (relative to this file), or the robot's fields.");
    v("task", &RunConfig::task, "The kind of task and its fields.");
    v("start", &RunConfig::start,
      "Places of the robot's base around the task's object, for any task.");
    v("randomize", &RunConfig::randomize,
      "Random lights, looks, physics, delays and clutter. Unset: none of them varies.");
    v("sampler", &RunConfig::sampler,
      "Sampler of the starts: a registered kind. Unset: the task's own.");
    v("expert", &RunConfig::expert,
      "Source of the actions: a registered kind of expert. Unset: the task's own expert. "
      "`robocell evaluate` writes its policy here, `module:Class`.");
    v("augment", &RunConfig::augment,
      "Source episodes that are moved to new starts, instead of an expert. Unset: none.");
    v("noise", &RunConfig::noise,
      "Noise on the actions, which are recorded with and without it. Unset: none.");
    v("scenes", &RunConfig::scenes,
      "Source of the scenes: its kind, `houses` and the fields of that kind.");
    v("episodes_per_scene", &RunConfig::episodes_per_scene, "Episodes made in each scene.",
      Bound::kPositive);
    v("cameras", &RunConfig::cameras, "Image size and streams.");
    v("features", &RunConfig::features,
      "Registered features of your own that are observed and recorded beside the built-in ones.");
    v("rates", &RunConfig::rates, "Rates of engine, controllers and actions.");
    v("options", &RunConfig::options, "Solver options.");
    v("keep", &RunConfig::keep,
      "Rollouts to keep: successes; first (the first rollout of each episode with any result, for "
      "evaluation); or all (failures too, labelled).");
    v("render", &RunConfig::render,
      "Rollouts whose images are drawn: always (each one, beside its physics) or kept (only those "
      "that are kept, after they have ended). The episodes are the same. Unset: as the dataset was "
      "begun, else always.");
    v("max_attempts", &RunConfig::max_attempts, "Largest number of attempts for an episode.",
      Bound::kPositive);
    v("episodes", &RunConfig::episodes,
      "Number of episodes in all; the scenes take turns. Unset: episodes_per_scene for each scene.",
      Bound::kPositive);
    v("workers", &RunConfig::workers, "Worker processes.", Bound::kPositive);
    v("seed", &RunConfig::seed, "Seed of the run. All its random numbers follow from it.",
      Bound::kNonNegative);
    v("output", &RunConfig::output, "Folder of the dataset, relative to the working folder.");
    v("imports", &RunConfig::imports,
      "Python modules and shared libraries (.so) that register this run's kinds of tasks, experts, "
      "scene sources, samplers or features, by name or by file relative to this one. The run "
      "imports them when it starts.");
  }
  void Validate(Problems& problems) const;

  // Reads a run file and the robot file that it names. Throws SpecError with all problems and their
  // file:line:column.
  static RunConfig Load(const std::string& path);
};

// A module or library that a run file imports, and its place in the file: "run.yaml:3:11".
struct RunImport {
  std::string name;
  std::string place;
};
// Returns the `imports` of a run file before the rest of it can be read. Empty for a file that
// cannot be read: Load reports its problems.
std::vector<RunImport> ImportsOfRunFile(const std::string& path);

}  // namespace robocell
