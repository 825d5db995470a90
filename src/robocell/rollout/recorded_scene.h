// The scene an episode was made in, such that it can be built anywhere: the spec names its models
// as every machine knows them, and the dataset keeps their files (data/model_store.h).
//
//   const PortableScene portable = MakePortable(scene.spec());   // recording
//   Scene scene = Scene::Build(RecordedScene(episode));          // replaying
#pragma once

#include <map>
#include <string>

#include "robocell/base/file_set.h"
#include "robocell/data/episode_reader.h"
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

}  // namespace robocell
