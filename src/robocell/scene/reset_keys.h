// Private to scene: the keyframes that a reset starts from.
#pragma once

#include <mujoco/mujoco.h>

#include <optional>
#include <string>
#include <vector>

#include "robocell/scene/scene.h"

namespace robocell {

// Numbers of keyframes: `start`, then those that change parts of it.
struct StartKeys {
  int start = -1;  // -1: the model's default configuration
  std::vector<int> over = {};
};

// Home when nothing is chosen. ArgumentError for a number, and NotFoundError with the nearest names
// for a name that is not there; `context` names the scene.
StartKeys FindStartKeys(const CompiledScene& compiled, const std::optional<KeyframeChoice>& choice,
                        const std::string& context);

// Restores a keyframe over another that has the differing values.
void RestoreKeys(const mjModel* model, mjData* data, const StartKeys& keys,
                 const std::string& context);

}  // namespace robocell
