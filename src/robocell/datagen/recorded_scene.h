// The scene an episode was made in, as the episode keeps it: the spec in its metadata, and the
// folders that relative model files start from in its `run` block, as they differ between machines.
//
//   Scene scene = Scene::Build(RecordedScene(episode));
#pragma once

#include <string>

#include "robocell/data/episode_reader.h"
#include "robocell/spec/scene_spec.h"

namespace robocell {

// For EpisodeSummary::run_json: {"model_folders": {"scene": ..., "robots": {"rc7": ...}}}, without
// what is empty.
std::string ModelFoldersJson(const SceneSpec& scene);

// ArgumentError when the episode's metadata has no scene_spec: only generated episodes have it.
// Folders that are not there any more are left out: ROBOCELL_MODEL_PATH may name others.
SceneSpec RecordedScene(const Episode& episode);

}  // namespace robocell
