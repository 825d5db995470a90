// Private to rollout: how the engine solved an episode's contacts, kept in the metadata of the
// episode as `engine: {jacobian: dense, solver: newton, guards: [sparse_newton]}`, and put back
// when the episode's scene is built again.
#pragma once

#include <string>
#include <nlohmann/json_fwd.hpp>

#include "robocell/scene/scene.h"

namespace robocell {

nlohmann::json EngineRecord(const Scene& scene);

// Makes the scene of an episode solve as it was recorded, whatever engine it is built with: with a
// dense Jacobian when a guard or a user made it dense, a sparse one when a user made it sparse, and
// without the guard when the episode is older than it. What the scene's own options say stays.
// SpecError, which begins with `place`, when the metadata's `engine` is not as it is written.
void RestoreEngine(const nlohmann::json& metadata, SceneSpec& scene, const std::string& place);

}  // namespace robocell
