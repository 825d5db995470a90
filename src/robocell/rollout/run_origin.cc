#include "robocell/rollout/run_origin.h"

#include <filesystem>
#include <set>
#include <nlohmann/json.hpp>

#include "robocell/assets/model_files.h"
#include "robocell/base/error.h"
#include "robocell/data/dataset.h"
#include "robocell/data/model_store.h"
#include "robocell/rollout/episode_reading.h"
#include "robocell/rollout/plan.h"

namespace robocell::internal {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

std::string NameOfFile(const std::string& path) { return fs::path(path).filename().string(); }

}  // namespace

RunOrigin::RunOrigin(const RunConfig& run)
    : run_(run), now_{.identity = RunIdentity(run), .versions = VersionsNow(), .files = {}} {}

std::set<std::string>& RunOrigin::StoredPathsOf(const std::string& name) {
  if (!models_) {
    models_.emplace();
    for (const std::string& model : ModelsOf(run_)) (*models_)[NameOfFile(model)].insert(model);
  }
  const auto [it, is_new] = stored_.try_emplace(name);
  if (!is_new) return it->second;
  for (const std::string& model : (*models_)[name])
    it->second.insert(StoredModelPath(ModelFileSet(model)));
  return it->second;
}

std::optional<std::vector<InputDifference>> RunOrigin::ChangesSince(const Episode& episode) {
  const Json metadata = Json::parse(episode.metadata_json());
  if (!metadata.is_object() || !metadata.contains("identity")) return std::nullopt;
  RunInputs then{.identity = metadata.at("identity"), .versions = {}, .files = {}};
  const Json versions = Json::parse(episode.versions_json());
  for (const auto& [part, version] : now_.versions) then.versions[part] = versions.value(part, "");
  RunInputs now = now_;
  if (metadata.value("task", "") == "custom") return Differences(then, now);
  for (const auto& [known_as, path] : episode.models()) {
    const std::string name = NameOfFile(path);
    std::set<std::string>& stored = StoredPathsOf(name);
    if (stored.empty() || stored.contains(path)) continue;
    if (IsModelOfRun(run_.output, path)) {
      stored.insert(path);
      continue;
    }
    then.files[name] = path;
    now.files[name] = *stored.begin();
  }
  return Differences(then, now);
}

namespace {

// Returns the dataset; unset for a folder with other contents.
std::optional<Dataset> DatasetIn(const std::string& folder) {
  try {
    return Dataset(folder);
  } catch (const ArgumentError&) {
    return std::nullopt;
  }
}

}  // namespace

std::vector<std::string> UnregisteredParts(const Episode& episode) {
  std::vector<std::string> parts;
  const std::optional<EpisodeJson> stored = EpisodeJson::Metadata(episode).Find(kUnregisteredParts);
  if (!stored) return parts;
  for (const EpisodeJson& part : stored->Items()) parts.push_back(part.AsText());
  return parts;
}

std::optional<std::vector<InputDifference>> ChangesSinceEpisodes(const RunConfig& run) {
  const std::optional<Dataset> dataset = DatasetIn(run.output);
  if (!dataset) return std::nullopt;
  RunOrigin origin(run);
  bool found = false;
  std::set<InputDifference> changes;
  for (const Episode& episode : *dataset) {
    const auto since = origin.ChangesSince(episode);
    if (!since) continue;
    found = true;
    changes.insert(since->begin(), since->end());
  }
  if (!found) return std::nullopt;
  return std::vector<InputDifference>(changes.begin(), changes.end());
}

}  // namespace robocell::internal
