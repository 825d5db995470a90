// The inputs of a run's episodes: its configuration, the files of its models, and the versions that
// compute them. A dataset stores them and never mixes episodes of different inputs.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "robocell/spec/run_config.h"

namespace robocell {

struct RunInputs {
  std::string identity;                         // RunIdentity
  std::map<std::string, std::string> versions;  // "mujoco" -> "4.0.0"
  std::map<std::string, std::string> files;     // "rc7/rc7.xml" -> SHA-256
  // Paths of the models on this machine; not compared.
  std::map<std::string, std::filesystem::path> paths = {};
};

// Returns the paths of the models: of the robot with its attachments, the scenes and the objects
// that the task may use. Throws NotFoundError for missing models.
std::vector<std::string> ModelsOf(const RunConfig& run);

// Returns the present versions of robocell and MuJoCo.
std::map<std::string, std::string> VersionsNow();

// Returns the inputs of a run, with the files of ModelsOf and those of the scenes' annotations.
RunInputs InputsOf(const RunConfig& run);

// A field, version or file that is another one than before.
struct InputDifference {
  // The whole in a line: "task.base_distance: [0.3, 0.55] then, [0.2, 0.5] now", "model file
  // rc7/rc7.xml: changed since then".
  std::string text;
  std::string field = {};  // "task.base_distance" or "mujoco"; "" for a file

  bool operator==(const InputDifference&) const = default;
  bool operator<(const InputDifference& other) const {
    return std::tie(text, field) < std::tie(other.text, other.field);
  }
};

// Returns the differences; empty if there are none. The folder of a model may have been renamed.
std::vector<InputDifference> Differences(const RunInputs& then, const RunInputs& now);
// Returns their texts.
std::vector<std::string> LinesOf(const std::vector<InputDifference>& differences);

// Returns the local source files of the run's task and features whose content matches none of those
// that a dataset was begun with.
std::vector<std::string> CodeChanges(const RunInputs& then, const RunConfig& run);

// Checks that the files of a run's models are unchanged since the run was compared with its
// dataset. Code that compiles them later calls it, so that a robot edited during a run does not
// give a dataset of two robots.
//
//   const RunFilesWatch watch(RequireSameRun(run));
//   ... sample, compile, act ...
//   watch.RequireUnchanged(run);   // before anything is kept
//
// A check looks at each file (microseconds) and reads its content only when the system reports
// another file.
class RunFilesWatch {
 public:
  RunFilesWatch() = default;
  explicit RunFilesWatch(RunInputs inputs) : inputs_(std::move(inputs)) {}
  // Throws IoError that names the changed or missing files and what to do.
  void RequireUnchanged(const RunConfig& run) const;

 private:
  RunInputs inputs_;
};

}  // namespace robocell
