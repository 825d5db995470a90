// Checks a keyframe before a reset, for callers that change things of their own before it.
#pragma once

#include "robocell/scene/scene.h"

namespace robocell::internal {

// Throws what Scene::Reset would throw for this keyframe.
void RequireKeyframe(const Scene& scene, const KeyframeChoice& keyframe);

}  // namespace robocell::internal
