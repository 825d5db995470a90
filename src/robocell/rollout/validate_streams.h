// Whether the image streams of a run can be recorded: by their fields, and on this machine.
#pragma once

#include <string>
#include <vector>

#include "robocell/scene/scene.h"
#include "robocell/spec/problems.h"
#include "robocell/spec/run_config.h"

namespace robocell {

// What a spec may say but an episode cannot hold: adds problems at cameras.streams[i].
void ValidateStreams(const RunConfig& run, Problems& problems);

// Draws one image of each stream, with the settings of the run. IoError without an encoder, Error
// without OpenGL, each saying who needs it; what cannot be drawn becomes a problem of its stream.
// Nothing without streams. `scene` must have the streams' cameras.
void ValidateStreamsHere(const RunConfig& run, const Scene& scene, Problems& problems);

}  // namespace robocell
