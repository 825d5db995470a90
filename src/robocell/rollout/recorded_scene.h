// The scene of an episode in a form that can be built anywhere: the spec's model names are valid on
// every machine, and the dataset keeps the files (data/model_store.h).
//
//   const PortableScene portable = MakePortable(scene.spec());   // recording
//   Scene scene = Scene::Build(RecordedScene(episode));          // replaying
#pragma once

#include <map>
#include <string>
#include <nlohmann/json_fwd.hpp>

#include "robocell/base/file_set.h"
#include "robocell/data/episode_reader.h"
#include "robocell/scene/scene.h"
#include "robocell/spec/scene_spec.h"

namespace robocell {

struct PortableScene {
  // Built-in models are named like "rc7", those of the Menagerie like
  // "menagerie:ufactory_xarm7/xarm7.xml", others by their path in the dataset.
  SceneSpec spec;
  std::map<std::string, FileSet> models;  // files by portable model name
};

// Throws NotFoundError for missing models.
PortableScene MakePortable(const SceneSpec& scene);

// Returns the scene with the models that the dataset keeps. Models that are missing there, for
// example because the episode was taken out of its dataset, are looked up by name. Throws SpecError
// if they differ from the recorded ones, NotFoundError if there are none, and ArgumentError if the
// episode's metadata has no scene_spec, which only generated episodes have.
SceneSpec RecordedScene(const Episode& episode);

// Returns how the engine solved an episode's contacts. The episode's metadata keeps it as `engine:
// {jacobian: dense, solver: newton, guards: [sparse_newton]}`, and building the episode's scene
// restores it.
nlohmann::json EngineRecord(const Scene& scene);

// Makes the scene of an episode solve its contacts as recorded, with any engine version:
// with a dense Jacobian if a guard or a user made it dense, a sparse one if a user made it sparse,
// and without the guard if the episode is older than the guard. The scene's own options take
// precedence. Throws SpecError, which begins with `place`, if the metadata's `engine` is malformed.
void RestoreEngine(const nlohmann::json& metadata, SceneSpec& scene, const std::string& place);

}  // namespace robocell
