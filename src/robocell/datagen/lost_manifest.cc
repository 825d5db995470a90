#include "robocell/datagen/lost_manifest.h"

#include <filesystem>
#include <map>
#include <set>
#include <nlohmann/json.hpp>

#include "robocell/assets/model_files.h"
#include "robocell/assets/portable_name.h"
#include "robocell/base/error.h"
#include "robocell/data/dataset.h"
#include "robocell/data/model_store.h"

namespace robocell {
namespace {

using Json = nlohmann::json;

// A model by its portable name, else its file's name.
std::string KeyOf(const std::string& name) {
  return IsStoredModelPath(name) ? std::filesystem::path(name).filename().string() : name;
}

// Where models are kept, by their keys; several files may have one name.
using StoredPaths = std::map<std::string, std::set<std::string>>;

StoredPaths StoredPathsOf(const RunConfig& run) {
  StoredPaths paths;
  for (const std::string& model : ModelsOf(run)) {
    const std::string stored = StoredModelPath(ModelFileSet(model));
    paths[assets::PortableName(model).value_or(KeyOf(stored))].insert(stored);
  }
  return paths;
}

// What an episode was made with, of what `now` knows. Its models stand in for the files.
RunInputs InputsIn(const Episode& episode, const std::string& identity, const RunInputs& now,
                   const StoredPaths& stored) {
  RunInputs then{.identity = identity, .versions = {}, .files = now.files};
  const Json versions = Json::parse(episode.versions_json());
  for (const auto& [part, version] : now.versions) then.versions[part] = versions.value(part, "");
  for (const auto& [name, path] : episode.models()) {
    const auto it = stored.find(KeyOf(name));
    if (it != stored.end() && !it->second.contains(path)) then.files[it->first] = path;
  }
  return then;
}

// Unset for a folder that holds other things.
std::optional<Dataset> DatasetIn(const std::string& folder) {
  try {
    return Dataset(folder);
  } catch (const ArgumentError&) {
    return std::nullopt;
  }
}

}  // namespace

std::optional<std::vector<std::string>> ChangesSinceEpisodes(const RunConfig& run,
                                                             const RunInputs& now) {
  RunInputs inputs = now;
  const StoredPaths stored = StoredPathsOf(run);
  inputs.files.clear();
  for (const auto& [key, paths] : stored) inputs.files[key] = *paths.begin();
  const std::optional<Dataset> dataset = DatasetIn(run.output);
  if (!dataset) return std::nullopt;
  bool found = false;
  std::set<std::string> changes;
  for (const Episode& episode : *dataset) {
    const Json identity = Json::parse(episode.metadata_json()).value("identity", Json());
    if (!identity.is_string()) continue;
    found = true;
    for (std::string& line : Differences(InputsIn(episode, identity, inputs, stored), inputs))
      changes.insert(std::move(line));
  }
  if (!found) return std::nullopt;
  return std::vector<std::string>(changes.begin(), changes.end());
}

}  // namespace robocell
