#include "robocell/rollout/dataset_run.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <set>
#include <string_view>
#include <utility>
#include <nlohmann/json.hpp>

#include "robocell/base/error.h"
#include "robocell/data/dataset_reports.h"
#include "robocell/rollout/episode_reading.h"
#include "robocell/rollout/prepare.h"
#include "robocell/rollout/recorded_scene.h"
#include "robocell/rollout/registered_kinds.h"
#include "robocell/rollout/run_origin.h"

namespace robocell {
namespace {

// Reads the digits at the beginning of `text` and removes them.
std::optional<int> TakeNumber(std::string_view& text) {
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || number < 0) return std::nullopt;
  text.remove_prefix(static_cast<size_t>(end - text.data()));
  return number;
}

bool TakePrefix(std::string_view& text, std::string_view prefix) {
  if (!text.starts_with(prefix)) return false;
  text.remove_prefix(prefix.size());
  return true;
}

// Replaces the files of the scenes by those that the episodes keep: they need not be here any more.
void UseRecordedFiles(const Dataset& dataset, FilesScenes& scenes) {
  std::set<size_t> missing;
  for (size_t i = 0; i < scenes.files.size(); ++i) missing.insert(i);
  for (size_t i = 0; i < dataset.size() && !missing.empty(); ++i) {
    const std::optional<PlanNumbers> numbers = NumbersOfId(dataset.ids()[i]);
    if (!numbers || !missing.contains(static_cast<size_t>(numbers->scene))) continue;
    const std::optional<std::string> base = RecordedScene(dataset.At(i)).base;
    if (!base || base->empty()) continue;
    scenes.files[static_cast<size_t>(numbers->scene)] = *base;
    missing.erase(static_cast<size_t>(numbers->scene));
  }
}

}  // namespace

Episode FirstEpisodeOfRun(const Dataset& dataset) {
  if (dataset.size() == 0) {
    throw ArgumentError(
        fmt::format("'{}' has no episode, so its cell is unknown", dataset.folder().string()));
  }
  Episode first = dataset.At(0);
  const internal::EpisodeJson metadata = internal::EpisodeJson::Metadata(first);
  if (metadata.Find("identity")) return first;
  const std::string folder = dataset.folder().string();
  if (metadata.Find("environment")) {
    throw ArgumentError(fmt::format(
        "'{}' was recorded from an environment, not made by a run, so there is no run to go on "
        "with; robocell.envs.from_dataset, in C++ EnvOfEpisode, makes the environment",
        folder));
  }
  throw ArgumentError(
      fmt::format("'{}' was recorded row by row (EpisodeWriter, `robocell import`), not made by a "
                  "run, so its cell is unknown; a policy acts in an environment of your own, with "
                  "env.row() and env.step()",
                  folder));
}

RunConfig RunOfDataset(const Dataset& dataset) {
  const std::string folder = dataset.folder().string();
  const Episode first = FirstEpisodeOfRun(dataset);
  if (const std::vector<std::string> parts = internal::UnregisteredParts(first);
      std::ranges::find(parts, "sampler") != parts.end()) {
    throw ArgumentError(fmt::format(
        "the starts of '{}' come from a sampler that was given to a Runner, so no name in the "
        "dataset stands for it: they cannot be made again, and neither the environment nor the "
        "evaluation of its task. Register the sampler, and make the dataset with `sampler: NAME` "
        "in its run",
        folder));
  }
  const internal::EpisodeJson identity = internal::EpisodeJson::Metadata(first).At("identity");
  const std::vector<std::string> unknown = internal::UnregisteredKinds(identity.AsText());
  if (!unknown.empty()) {
    throw SpecError(fmt::format("the run that made '{}': {}", folder, fmt::join(unknown, "; ")));
  }
  auto run = identity.AsSpec<RunConfig>();
  run.output.clear();   // another dataset goes elsewhere
  run.augment.reset();  // the sources of its episodes are not in it
  run.noise.reset();    // policies are judged without it
  const SceneSpec scene = RecordedScene(first);
  if (scene.robots.empty() || !scene.robots[0].config) {
    throw ArgumentError(fmt::format("'{}': the scene of '{}' has no robot configuration", folder,
                                    dataset.ids().front()));
  }
  run.robot.config = *scene.robots[0].config;
  if (const std::vector<std::string> changed = ChangedCode(folder, run); !changed.empty()) {
    throw SpecError(
        fmt::format("'{}' was made with other code: {} changed since then, so that the task may be "
                    "another one. Restore the code, or make a new dataset",
                    folder, fmt::join(changed, ", ")));
  }
  run.scenes.houses.values = HousesOfDataset(dataset);
  if (auto* files = run.scenes.If<FilesScenes>()) UseRecordedFiles(dataset, *files);
  return run;
}

std::vector<int> HousesOfDataset(const Dataset& dataset) {
  std::optional<std::vector<int>> houses = HousesOfReports(dataset.folder());
  if (houses && houses->empty()) return {};
  if (!houses) houses.emplace();
  for (const std::string& id : dataset.ids()) {
    const std::optional<PlanNumbers> numbers = NumbersOfId(id);
    if (numbers && std::ranges::find(*houses, numbers->scene) == houses->end())
      houses->push_back(numbers->scene);
  }
  return *houses;
}

std::optional<PlanNumbers> NumbersOfId(const std::string& id) {
  std::string_view text = id;
  if (!TakePrefix(text, "s")) return std::nullopt;
  const std::optional<int> scene = TakeNumber(text);
  if (!scene || !TakePrefix(text, "_e")) return std::nullopt;
  const std::optional<int> episode = TakeNumber(text);
  if (!episode) return std::nullopt;
  return PlanNumbers{.scene = *scene, .episode = *episode};
}

}  // namespace robocell
