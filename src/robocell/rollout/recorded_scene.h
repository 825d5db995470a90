// The scene an episode was made in, such that it can be built anywhere: the spec names its models
// as every machine knows them, and the dataset keeps their files (data/model_store.h).
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
  // Models are named "rc7" when they are built in, "menagerie:ufactory_xarm7/xarm7.xml" when they
  // are of the Menagerie, else by where the dataset keeps them.
  SceneSpec spec;
  std::map<std::string, FileSet> models;  // by these names
};

// NotFoundError for models that are not there.
PortableScene MakePortable(const SceneSpec& scene);

// With the models that the dataset keeps. Models that are not there, as when an episode was taken
// out of its dataset, are looked for by their names; SpecError when those are other ones than were
// recorded, NotFoundError when there are none. ArgumentError when the episode's metadata has no
// scene_spec: only generated episodes have it.
SceneSpec RecordedScene(const Episode& episode);

// How the engine solved an episode's contacts, kept in the metadata of the episode as
// `engine: {jacobian: dense, solver: newton, guards: [sparse_newton]}`, and put back when the
// episode's scene is built again.
nlohmann::json EngineRecord(const Scene& scene);

// Makes the scene of an episode solve as it was recorded, whatever engine it is built with: with a
// dense Jacobian when a guard or a user made it dense, a sparse one when a user made it sparse, and
// without the guard when the episode is older than it. What the scene's own options say stays.
// SpecError, which begins with `place`, when the metadata's `engine` is not as it is written.
void RestoreEngine(const nlohmann::json& metadata, SceneSpec& scene, const std::string& place);

}  // namespace robocell
