// Compiled scenes on the disk, known by what they are made of: the second process that needs a
// scene reads the engine's binary instead of parsing meshes again.
//
//   std::shared_ptr<CompiledScene> compiled = CompileSceneCached(spec);
//   Scene scene = Scene::FromCompiled(compiled);
//
// A scene is found again when the spec, the content of every file its models consist of, and the
// versions of MuJoCo and robocell are the same; where the files lie does not matter. Entries are
// complete or absent and checked against their fingerprint when they are read; a damaged one is
// made anew. Any number of threads and processes may use one folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "robocell/scene/compiled_scene.h"

namespace robocell {

inline constexpr uint64_t kSceneCacheBytes = 4ULL << 30;  // kept at most, before the oldest go

// ROBOCELL_CACHE_DIR, else the user's cache folder (XDG_CACHE_HOME, ~/.cache) and "robocell"; in it
// "scenes".
std::filesystem::path SceneCacheFolder();

// As CompileScene, with its errors. A cache that cannot be written costs a warning in the log, not
// the scene. What needs the editable description (saving as XML) compiles it when it is asked for.
std::shared_ptr<CompiledScene> CompileSceneCached(
    const SceneSpec& spec, const std::filesystem::path& folder = SceneCacheFolder());

// Returns the key of a scene in the cache: hexadecimal digits. NotFoundError for models that do not
// exist.
std::string SceneKey(const SceneSpec& spec);

// Removes entries, those that were not used for longest first, until `most_bytes` are left.
void PruneSceneCache(const std::filesystem::path& folder, uint64_t most_bytes);

}  // namespace robocell
