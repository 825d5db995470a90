// The inputs of a run's episodes: its configuration, the files of its models, and the versions that
// compute them. A dataset remembers them and never becomes a mixture.
#pragma once

#include <filesystem>
#include <map>
#include <string>
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

// Paths of the models: of the robot with its attachments, the scenes and the objects that the task
// may use. NotFoundError for models that are not there.
std::vector<std::string> ModelsOf(const RunConfig& run);

// The present versions of robocell and MuJoCo.
std::map<std::string, std::string> VersionsNow();

// The files are those of ModelsOf.
RunInputs InputsOf(const RunConfig& run);

// Returns the differences, one line each: "task.base_distance: [0.3, 0.55] then, [0.2, 0.5] now",
// "mujoco: 3.9.0 then, 4.0.0 now", "model file rc7/rc7.xml: changed since then". Empty without any.
// The folder of a model may have another name than then.
std::vector<std::string> Differences(const RunInputs& then, const RunInputs& now);

// Source files of the run's task and features, as they are here, whose content is none of those that
// a dataset was begun with.
std::vector<std::string> CodeChanges(const RunInputs& then, const RunConfig& run);

// Are the files of a run's models still what they were when the run was compared with its dataset?
// Whoever compiles them afterwards asks, so that editing a robot while a run goes on makes no
// dataset of two robots.
//
//   const RunFilesWatch watch(RequireSameRun(run));
//   ... sample, compile, act ...
//   watch.RequireUnchanged(run);   // before anything is kept
//
// Asking costs a look at each file (microseconds); what they hold is read again only when the
// system says that they are other files.
class RunFilesWatch {
 public:
  RunFilesWatch() = default;
  explicit RunFilesWatch(RunInputs inputs) : inputs_(std::move(inputs)) {}
  // IoError that names the files that are others now, or gone, and what to do.
  void RequireUnchanged(const RunConfig& run) const;

 private:
  RunInputs inputs_;
};

}  // namespace robocell
