#include "robocell/datagen/recorded_scene.h"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "robocell/assets/model_files.h"
#include "robocell/assets/portable_name.h"
#include "robocell/assets/resolve.h"
#include "robocell/assets/scene_models.h"
#include "robocell/base/error.h"
#include "robocell/data/model_store.h"
#include "robocell/spec/yaml.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;

// Finds the models of an episode.
class Models {
 public:
  explicit Models(const Episode& episode)
      : name_(fmt::format("episode '{}'", episode.folder().string())),
        dataset_(fs::absolute(episode.folder()).lexically_normal().parent_path()),
        kept_(episode.models()) {}

  // The file behind a name in the episode's spec.
  std::string Find(const std::string& name) const {
    const auto it = kept_.find(name);
    if (it == kept_.end()) return name;  // recorded before models were kept
    std::error_code ignored;
    if (!fs::is_regular_file(dataset_ / it->second, ignored)) return Elsewhere(name, it->second);
    if (StoredModelIsIntact(dataset_, it->second)) return (dataset_ / it->second).string();
    throw IoError(fmt::format("{}: '{}' is not what was stored; see `robocell verify {}`", name_,
                              (dataset_ / it->second).string(), dataset_.string()));
  }

 private:
  std::string Elsewhere(const std::string& name, const std::string& path) const {
    if (name == path)
      throw NotFoundError(
          fmt::format("{}: its model '{}' is not in '{}'; keep an episode in its "
                      "dataset, or copy `models` with it",
                      name_, path, dataset_.string()));
    const std::string found = assets::Resolve(name);
    if (StoredModelPath(ModelFileSet(found)) == path) return found;
    throw SpecError(
        fmt::format("{}: model '{}' of this machine ({}) is not the one it was made "
                    "with, and '{}' is not in '{}'",
                    name_, name, found, path, dataset_.string()));
  }

  std::string name_;
  fs::path dataset_;
  std::map<std::string, std::string> kept_;
};

}  // namespace

PortableScene MakePortable(const SceneSpec& scene) {
  PortableScene portable{.spec = scene, .models = {}};
  assets::ForEachModel(portable.spec, [&](std::string& name, const std::string& directory) {
    const std::string path = assets::Resolve(name, directory);
    FileSet files = ModelFileSet(path);
    name = assets::PortableName(path).value_or(StoredModelPath(files));
    portable.models.emplace(name, std::move(files));
  });
  return portable;
}

SceneSpec RecordedScene(const Episode& episode) {
  const auto metadata = nlohmann::json::parse(episode.metadata_json());
  if (!metadata.contains("scene_spec") || !metadata["scene_spec"].is_string()) {
    throw ArgumentError(fmt::format(
        "episode '{}': its metadata has no scene_spec; episodes that robocell generated "
        "have one",
        episode.folder().string()));
  }
  SceneSpec scene = FromYamlUnchecked<SceneSpec>(metadata["scene_spec"].get<std::string>());
  const Models models(episode);
  assets::ForEachModel(scene,
                       [&](std::string& name, const std::string&) { name = models.Find(name); });
  return scene;
}

}  // namespace robocell
