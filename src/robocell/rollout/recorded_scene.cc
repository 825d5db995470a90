#include "robocell/rollout/recorded_scene.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <set>
#include <nlohmann/json.hpp>

#include "robocell/assets/model_files.h"
#include "robocell/assets/resolve.h"
#include "robocell/assets/scene_models.h"
#include "robocell/base/error.h"
#include "robocell/base/file_set.h"
#include "robocell/base/paths.h"
#include "robocell/data/model_store.h"
#include "robocell/rollout/episode_reading.h"
#include "robocell/spec/yaml.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;

bool IsInside(const fs::path& folder, const fs::path& file) {
  const fs::path inside = fs::weakly_canonical(file).lexically_relative(fs::canonical(folder));
  return !inside.empty() && *inside.begin() != "..";
}

std::set<std::string> HashesIn(const fs::path& folder) {
  std::set<std::string> hashes;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) hashes.insert(HashOfFile(entry.path()));
  }
  return hashes;
}

// A foreign dataset must not reach for files of this machine: files that its models name are kept
// beside them, or are identical to the local file.
void RequireSelfContained(const std::string& episode, const fs::path& folder,
                          const fs::path& model) {
  std::optional<std::set<std::string>> kept;
  const internal::ModelFiles found = internal::FindModelFiles(model);
  for (const fs::path& file : found.files) {
    if (IsInside(folder, file)) continue;
    if (!kept) kept = HashesIn(folder);
    if (kept->contains(HashOfFile(file))) continue;
    throw SpecError(fmt::format(
        "{}: its model '{}' names '{}', which is outside the files stored for this model ('{}')",
        episode, model.string(), file.string(), folder.string()));
  }
  for (const internal::MissingFile& missing : found.missing) {
    if (missing.name.empty())
      throw SpecError(fmt::format("{}: '{}' of its model cannot be read as XML: {}", episode,
                                  missing.document.string(), missing.reason));
    throw SpecError(fmt::format(
        "{}: its model '{}' names '{}', which is not among the files stored for this model "
        "('{}'): {}",
        episode, missing.document.string(), missing.name, folder.string(), missing.reason));
  }
}

// Finds the models of an episode.
class Models {
 public:
  explicit Models(const Episode& episode)
      : name_(fmt::format("episode '{}'", episode.folder().string())),
        dataset_(fs::absolute(episode.folder()).lexically_normal().parent_path()),
        kept_(episode.models()) {}

  // Returns the file behind a name in the episode's spec.
  std::string Find(const std::string& name) const {
    const auto it = kept_.find(name);
    if (it == kept_.end()) return NotKept(name);
    const fs::path model = dataset_ / it->second;
    std::error_code ignored;
    if (!fs::is_regular_file(model, ignored)) return Elsewhere(name, it->second);
    if (internal::DamageOfStoredModel(dataset_, it->second).empty()) {
      RequireSelfContained(name_, dataset_ / internal::StoredModelFolder(it->second), model);
      return model.string();
    }
    throw IoError(fmt::format("{}: '{}' differs from the stored model; see `robocell verify {}`",
                              name_, (dataset_ / it->second).string(),
                              internal::ShellWord(dataset_.string())));
  }

 private:
  // Resolves a model of an episode older than the model store: a name that is valid on every
  // machine.
  std::string NotKept(const std::string& name) const {
    if (!fs::path(name).is_absolute() && name.find("..") == std::string::npos) return name;
    throw SpecError(fmt::format(
        "{}: its scene names the model '{}', a file that the dataset does not keep", name_, name));
  }

  std::string Elsewhere(const std::string& name, const std::string& path) const {
    if (name == path)
      throw NotFoundError(
          fmt::format("{}: its model '{}' is not in '{}'; keep an episode in its "
                      "dataset, or copy `models` with it",
                      name_, path, dataset_.string()));
    const std::string found = assets::Resolve(name);
    if (internal::StoredModelPath(internal::ModelFileSet(found)) == path) return found;
    throw SpecError(
        fmt::format("{}: model '{}' of this machine ({}) is not the one it was made "
                    "with, and '{}' is not in '{}'",
                    name_, name, found, path, dataset_.string()));
  }

  std::string name_;
  fs::path dataset_;
  std::map<std::string, std::string> kept_;
};

const char* JacobianName(int jacobian) {
  return jacobian == mjJAC_DENSE ? "dense" : jacobian == mjJAC_SPARSE ? "sparse" : "auto";
}

const char* SolverName(int solver) {
  return solver == mjSOL_PGS ? "pgs" : solver == mjSOL_CG ? "cg" : "newton";
}

// The engine's part of an episode's metadata.
struct EngineText {
  std::string jacobian;
  bool is_guarded = false;
};

EngineText ReadEngine(const nlohmann::json& engine, const std::string& place) {
  const auto require = [&](bool good, const char* field, const char* what) {
    if (good) return;
    throw SpecError(fmt::format(
        "{}: metadata.engine{} is not {}; write it as it was recorded, such as {{\"jacobian\": "
        "\"dense\", \"solver\": \"newton\", \"guards\": [\"sparse_newton\"]}}, or leave engine "
        "out",
        place, field, what));
  };
  require(engine.is_object(), "", "an object");
  const auto guards = engine.find("guards");
  require(guards == engine.end() ||
              (guards->is_array() &&
               std::ranges::all_of(*guards, [](const auto& name) { return name.is_string(); })),
          ".guards", "a list of names");
  const auto jacobian = engine.find("jacobian");
  const bool is_known = jacobian == engine.end() || *jacobian == "dense" || *jacobian == "sparse" ||
                        *jacobian == "auto";
  require(is_known, ".jacobian", "one of dense, sparse and auto");
  return {.jacobian = jacobian == engine.end() ? "auto" : jacobian->get<std::string>(),
          .is_guarded = guards != engine.end() && !guards->empty()};
}

}  // namespace

PortableScene MakePortable(const SceneSpec& scene) {
  PortableScene portable{.spec = scene, .models = {}};
  internal::ForEachModel(portable.spec, [&](std::string& name, const std::string& directory) {
    const std::string path = assets::Resolve(name, directory);
    FileSet files = internal::ModelFileSet(path);
    name = assets::PortableName(path).value_or(internal::StoredModelPath(files));
    portable.models.emplace(name, std::move(files));
  });
  return portable;
}

SceneSpec RecordedScene(const Episode& episode) {
  const internal::EpisodeJson metadata = internal::EpisodeJson::Metadata(episode);
  const auto spec = metadata.Find("scene_spec");
  if (!spec) {
    throw ArgumentError(fmt::format(
        "episode '{}': its metadata has no scene_spec; episodes that robocell generated "
        "have one",
        episode.folder().string()));
  }
  const auto environment = metadata.Find("environment");
  const auto saved = environment ? environment->Find("saved_scene") : std::nullopt;
  if (saved && saved->AsBool()) {
    throw ArgumentError(fmt::format(
        "episode '{}': its scene was a saved file (saved_scene), which the dataset does not keep; "
        "replay it in an environment of that file: ReplayActions, env.replay(episode), or "
        "`robocell replay --env FILE`",
        episode.folder().string()));
  }
  SceneSpec scene = spec->AsSpec<SceneSpec>();
  RestoreEngine(metadata.value(), scene, fmt::format("episode '{}'", episode.folder().string()));
  const Models models(episode);
  internal::ForEachModel(scene,
                         [&](std::string& name, const std::string&) { name = models.Find(name); });
  return scene;
}

nlohmann::json EngineRecord(const Scene& scene) {
  const mjOption& used = scene.model()->opt;
  nlohmann::json guards = scene.compiled()->engine_guards();
  return {{"jacobian", JacobianName(used.jacobian)},
          {"solver", SolverName(used.solver)},
          {"guards", guards}};
}

void RestoreEngine(const nlohmann::json& metadata, SceneSpec& scene, const std::string& place) {
  const auto engine = metadata.find("engine");
  const EngineText text =
      engine == metadata.end() ? EngineText{.jacobian = "auto"} : ReadEngine(*engine, place);
  if (scene.options.jacobian) return;
  if (engine == metadata.end()) {
    scene.options.jacobian = JacobianKind::kAuto;
  } else if (text.is_guarded || text.jacobian == "dense") {
    scene.options.jacobian = JacobianKind::kDense;
  } else if (text.jacobian == "sparse") {
    scene.options.jacobian = JacobianKind::kSparse;
  }
}

}  // namespace robocell
