#include "robocell/datagen/recorded_scene.h"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "robocell/base/error.h"
#include "robocell/spec/yaml.h"

namespace robocell {
namespace {

using Json = nlohmann::json;

// A machine's own path as text that JSON can hold.
std::string Absolute(const std::string& folder) {
  return std::filesystem::absolute(folder).lexically_normal().string();
}

std::string IfThere(const Json& folders, const std::string& key) {
  const std::string folder = folders.value(key, "");
  std::error_code ignored;
  return std::filesystem::is_directory(folder, ignored) ? folder : "";
}

}  // namespace

std::string ModelFoldersJson(const SceneSpec& scene) {
  Json folders = Json::object();
  if (!scene.source_dir.empty()) folders["scene"] = Absolute(scene.source_dir);
  for (const RobotSpec& robot : scene.robots) {
    if (robot.config && !robot.config->source_dir.empty())
      folders["robots"][robot.config->name] = Absolute(robot.config->source_dir);
  }
  return Json{{"model_folders", folders}}.dump(-1, ' ', false, Json::error_handler_t::replace);
}

SceneSpec RecordedScene(const Episode& episode) {
  const Json metadata = Json::parse(episode.metadata_json());
  if (!metadata.contains("scene_spec") || !metadata["scene_spec"].is_string()) {
    throw ArgumentError(fmt::format(
        "episode '{}': its metadata has no scene_spec; episodes that robocell generated "
        "have one",
        episode.folder().string()));
  }
  SceneSpec scene = FromYamlUnchecked<SceneSpec>(metadata["scene_spec"].get<std::string>());
  const Json run = Json::parse(episode.run_json());
  const Json folders = run.value("model_folders", Json::object());
  scene.source_dir = IfThere(folders, "scene");
  const Json robots = folders.value("robots", Json::object());
  for (RobotSpec& robot : scene.robots) {
    if (robot.config) robot.config->source_dir = IfThere(robots, robot.config->name);
  }
  return scene;
}

}  // namespace robocell
