// A cache of compiled scenes on the disk, keyed by their sources: the second process that needs a
// scene reads the engine's binary instead of parsing meshes again.
//
//   std::shared_ptr<CompiledScene> compiled = CompileSceneCached(spec);
//   Scene scene = Scene::FromCompiled(compiled);
//
// A scene is found if the spec, the content of every file of its models, and the versions of MuJoCo
// and robocell are the same; the folders of the files do not matter. Entries are complete or absent
// and checked against their fingerprint when they are read; a damaged one is replaced. Any number
// of threads and processes may use one folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "robocell/scene/compiled_scene.h"

namespace robocell {

inline constexpr uint64_t kSceneCacheBytes = 4ULL << 30;  // largest size of the cache

// Returns ROBOCELL_CACHE_DIR, else the user's cache folder (XDG_CACHE_HOME, ~/.cache) and
// "robocell"; in it "scenes".
std::filesystem::path SceneCacheFolder();

// Like CompileScene, with its errors. A cache that cannot be written costs a warning in the log,
// not the scene. The editable description (for saving as XML) is compiled on demand.
std::shared_ptr<CompiledScene> CompileSceneCached(
    const SceneSpec& spec, const std::filesystem::path& folder = SceneCacheFolder());

// Returns the key of a scene in the cache: hexadecimal digits. Throws NotFoundError for missing
// models.
std::string SceneKey(const SceneSpec& spec);

// Removes the least recently used entries until `most_bytes` are left.
void PruneSceneCache(const std::filesystem::path& folder, uint64_t most_bytes);

}  // namespace robocell
