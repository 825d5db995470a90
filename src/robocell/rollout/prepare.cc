#include "robocell/rollout/prepare.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <thread>
#include <nlohmann/json.hpp>

#include "robocell/assets/model_files.h"
#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/function_name.h"
#include "robocell/base/io_error.h"
#include "robocell/base/log.h"
#include "robocell/base/make_directories.h"
#include "robocell/base/packed_index.h"
#include "robocell/data/dataset.h"
#include "robocell/data/dataset_lock.h"
#include "robocell/data/episode_files.h"
#include "robocell/data/episode_reader.h"
#include "robocell/data/model_store.h"
#include "robocell/rollout/run_inputs.h"
#include "robocell/rollout/run_origin.h"
#include "robocell/rollout/run_renderer.h"
#include "robocell/rollout/validate_run.h"
#include "robocell/scene/inspection/finding.h"
#include "robocell/spec/locations.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr size_t kMostLines = 30;
constexpr int kLockTries = 10;
constexpr std::chrono::milliseconds kLockPause(100);

std::string Manifest(const RunConfig& run, const RunInputs& inputs) {
  Json manifest{{"format", "robocell-dataset"},
                {"run", run.run},
                {"seed", run.seed},
                {"task", run.task.kind()},
                {"identity", inputs.identity},
                {"versions", inputs.versions},
                {"files", inputs.files}};
  if (const std::string backend = internal::BackendToBeginWith(run); !backend.empty()) {
    manifest["renderer"] = backend;
  }
  if (run.render) manifest["render"] = ToString(*run.render);
  return manifest.dump(2) + "\n";
}

// Throws Json::exception for a manifest in another format.
RunInputs InputsIn(const std::string& manifest) {
  const Json json = Json::parse(manifest);
  return {
      .identity = json.at("identity"), .versions = json.at("versions"), .files = json.at("files")};
}

void CreateFolder(const fs::path& folder) {
  internal::MakeDirectories(folder, "the dataset's folder");
  std::error_code error;
  // Only an attempt shows whether the folder can be written.
  fs::remove(MakeTempDirectory(folder, "probe"), error);
}

// Returns true for an entry that the run itself made or that an interrupted write left behind.
bool IsOfNoAccount(const std::string& name) {
  return IsTemporaryName(name) || name == kManifestFile || name == kLogsFolder ||
         name == kModelsFolder || name == kQuarantineFolder || name.starts_with(kLockFile) ||
         IsReportFile(name);
}

// Returns the name of the first other entry; "" if there is none.
std::string FirstEntry(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (!IsOfNoAccount(name)) names.push_back(name);
  }
  if (error) ThrowIoError("list the dataset's folder", folder, error.value());
  return names.empty() ? "" : *std::min_element(names.begin(), names.end());
}

// Returns the differences from the manifest; empty for the same run.
std::vector<InputDifference> Changes(const std::string& manifest, const RunInputs& inputs) {
  try {
    return Differences(InputsIn(manifest), inputs);
  } catch (const Json::exception& error) {
    return {{std::string("dataset.json has an unknown form; without it, the episodes "
                         "themselves are compared: ") +
             error.what()}};
  }
}

// Returns where a value was given; for a list, the option of the command line that replaced one of
// its numbers, if any did. "" for a default.
std::string PlaceOf(const RunConfig& run, const std::string& field) {
  for (int i = 0;; ++i) {
    const auto number = run.locations.Exactly(fmt::format("{}[{}]", field, i));
    if (!number) return run.locations.Exactly(field).value_or("");
    if (number->starts_with("--set ")) return *number;
  }
}

// Adds the place to a difference of a field that stands in the file: "run.yaml:4:30:
// task.base_distance: ...".
std::string InFile(const RunConfig& run, const InputDifference& difference) {
  const std::string place = difference.field.empty() ? "" : PlaceOf(run, difference.field);
  return WithPlace(place, difference.text);
}

// Names the place in the file that sets the dataset's folder.
[[noreturn]] void ThrowOfOutput(const RunConfig& run, const std::string& problem) {
  throw SpecError(WithPlace(run.locations.At("output"), "run '" + run.run + "': " + problem));
}

[[noreturn]] void ThrowChanged(const RunConfig& run,
                               const std::vector<InputDifference>& differences) {
  std::vector<std::string> lines;
  for (const InputDifference& difference : differences) {
    if (lines.size() < kMostLines) lines.push_back(InFile(run, difference));
  }
  if (differences.size() > kMostLines)
    lines.push_back(fmt::format("... and {} more", differences.size() - kMostLines));
  ThrowOfOutput(
      run,
      fmt::format(
          "the dataset '{}' was begun differently:\n  {}\n"
          "Change these back to go on with it, or give another `output` to start a new dataset",
          run.output, fmt::join(lines, "\n  ")));
}

void RequireOutput(const RunConfig& run) {
  if (!run.output.empty()) return internal::RequireNotPacked(run.output, "generate");
  ThrowOfOutput(run,
                "output: where should the dataset go? Give the folder, for example `output: "
                "experiment_output/" +
                    run.run + "`");
}

// Returns true if the dataset has to be begun, for the first time or anew. Throws SpecError if it
// must not be, because it has episodes of other inputs or foreign entries. The folder must exist.
bool MustBegin(const RunConfig& run, const RunInputs& inputs) {
  const std::string entry = FirstEntry(run.output);  // first: the manifest is older than episodes
  if (const std::optional<std::string> manifest = ReadManifest(run.output)) {
    const std::vector<InputDifference> changes = Changes(*manifest, inputs);
    if (!changes.empty() && !entry.empty()) ThrowChanged(run, changes);
    return !changes.empty();
  }
  if (entry.empty()) return true;
  if (const auto lost = internal::ChangesSinceEpisodes(run)) {
    if (!lost->empty()) ThrowChanged(run, *lost);
    return true;
  }
  ThrowOfOutput(
      run, fmt::format("output: the folder '{}' holds '{}' and is not a dataset; give a new folder",
                       run.output, entry));
}

// Returns the lock; unset while another process holds it.
std::optional<DatasetLock> TryAlone(const fs::path& dataset, bool last_try) {
  try {
    return DatasetLock::Alone(dataset);
  } catch (const IoError&) {
    if (last_try) throw;
    return std::nullopt;
  }
}

// Returns false if another process has just written the manifest, or has removed our unfinished
// one: generators remove the leftovers of dead processes, and single files do not show whether
// their process lives.
bool TryWriteManifest(const RunConfig& run, const RunInputs& inputs, bool last_try) {
  try {
    WriteManifest(run.output, Manifest(run, inputs));
    return true;
  } catch (const IoError& error) {
    if (error.system_error() != ENOENT || last_try) throw;
    return false;
  }
}

// Every process writes the same new manifest. One that replaces another is written under the lock,
// so that no episode is made meanwhile; another shard may be writing it too.
void WriteManifestIfDue(const RunConfig& run, const RunInputs& inputs) {
  for (int patience = kLockTries; MustBegin(run, inputs); --patience) {
    if (!ReadManifest(run.output)) {
      if (TryWriteManifest(run, inputs, patience == 0)) return;
    } else if (const auto lock = TryAlone(run.output, patience == 0)) {
      if (MustBegin(run, inputs)) WriteManifest(run.output, Manifest(run, inputs));
      return;
    }
    std::this_thread::sleep_for(kLockPause);
  }
}

// Stores the run's choice of what is drawn, so that later commands that make none go on with it.
// While another command is writing the dataset, its choice stays.
void StoreRender(const RunConfig& run) {
  const std::optional<std::string> manifest = ReadManifest(run.output);
  if (!manifest || !run.render) return;
  auto json = nlohmann::ordered_json::parse(*manifest);
  const std::string render = ToString(*run.render);
  if (json.value("render", "") == render) return;
  try {
    const DatasetLock lock = DatasetLock::Alone(run.output);
    json["render"] = render;
    WriteManifest(run.output, json.dump());
  } catch (const IoError& error) {
    LogInfo(fmt::format("render: {} is not stored for later commands: {}", render, error.what()));
  }
}

// Returns the folders in the dataset that keep an episode's models; none for an unreadable episode,
// which is reported elsewhere.
std::vector<std::string> ModelFoldersOf(const fs::path& episode) {
  std::vector<std::string> folders;
  try {
    for (const auto& [name, path] : Episode(episode).models())
      folders.push_back(internal::StoredModelFolder(path));
  } catch (const Error&) {
    return {};
  }
  return folders;
}

// Episodes bring their models when they are committed. This copies models that the dataset has lost
// since.
void RestoreModels(const RunConfig& run) {
  std::map<std::string, std::string> missing;  // folder in the dataset -> path of the model
  for (const std::string& model : ModelsOf(run)) {
    const std::string folder =
        internal::StoredModelFolder(internal::StoredModelPath(internal::ModelFileSet(model)));
    if (!internal::IsStored(run.output, folder)) missing.emplace(folder, model);
  }
  const Dataset dataset(run.output);
  for (auto id = dataset.ids().begin(); id != dataset.ids().end() && !missing.empty(); ++id) {
    for (const std::string& folder : ModelFoldersOf(fs::path(run.output) / *id)) {
      const auto found = missing.find(folder);
      if (found == missing.end()) continue;
      internal::StoreModel(run.output, internal::ModelFileSet(found->second));
      missing.erase(found);
    }
  }
}

}  // namespace

void PrepareDataset(const RunConfig& run, const PrepareOptions& options) {
  RequireOutput(run);
  if (options.validate) {
    for (const Finding& warning :
         ValidateRun(run, {.scripted_expert = false, .on_this_machine = false}))
      LogWarn(fmt::format("run '{}': {}", run.run, Line(warning)));
  }
  const RunInputs inputs = InputsOf(run);
  CreateFolder(run.output);
  WriteManifestIfDue(run, inputs);
  StoreRender(run);
  RestoreModels(run);
}

void ValidateDataset(const RunConfig& run) {
  RequireOutput(run);
  std::error_code error;
  if (fs::exists(run.output, error)) MustBegin(run, InputsOf(run));
  if (error) ThrowIoError("look at the dataset's folder", run.output, error.value());
}

std::vector<std::string> ChangedCode(const std::string& dataset, const RunConfig& run) {
  const std::optional<std::string> manifest = ReadManifest(dataset);
  if (!manifest) return {};
  try {
    return CodeChanges(InputsIn(*manifest), run);
  } catch (const Json::exception& error) {
    throw IoError(fmt::format("'{}/dataset.json' is damaged: {}", dataset, error.what()));
  }
}

RunInputs RequireSameRun(const RunConfig& run) {
  const std::optional<std::string> manifest = ReadManifest(run.output);
  if (!manifest) {
    throw SpecError(
        fmt::format("run '{}': '{}' is not a dataset: it has no dataset.json; first call {}",
                    run.run, run.output, internal::CppAndPythonName("PrepareDataset")));
  }
  RunInputs inputs = InputsOf(run);
  if (const auto changes = Changes(*manifest, inputs); !changes.empty()) ThrowChanged(run, changes);
  return inputs;
}

}  // namespace robocell
