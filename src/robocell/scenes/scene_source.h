// Where a run's episodes take place: the scene of its source, without robot and objects.
#pragma once

#include "robocell/spec/run_config.h"
#include "robocell/spec/scene_spec.h"

namespace robocell {

// Scene number `scene_index` of the run's source. NotFoundError for a file that is not there.
SceneSpec MakeBaseScene(const RunConfig& run, int scene_index);

}  // namespace robocell
