// The renderer of a run's images, and when it draws them. A run with the back end "auto" uses the
// one that its dataset was begun with, on every machine, so that all images of a dataset have one
// renderer. A run that does not say when it draws goes on like the last command that did.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "robocell/render/renderer.h"
#include "robocell/spec/run_config.h"

namespace robocell::internal {

// Returns the name of the back end: the run's own, else that of its dataset, else "auto".
std::string BackendOf(const RunConfig& run);

// Returns the back end to begin a dataset with. For a dataset with episodes it is the one that drew
// their images. "" for runs without cameras.
std::string BackendToBeginWith(const RunConfig& run);

// Returns which rollouts have their images drawn: what the run says, else what its dataset
// stores of the last command that said it, else all.
RenderWhen RenderOf(const RunConfig& run);

// Throws Error if the dataset's back end does not work here. Other errors are those of
// MakeRenderer.
std::unique_ptr<Renderer> MakeRendererOf(const RunConfig& run, const Visibility& visibility = {});

// Returns how many threads of a worker draw: the cores that the run's workers leave to each of them,
// at most three, which is more than the encoders of two cameras keep up with. Each takes the memory
// of a renderer: 50 MB for the Menagerie's Panda. `cores`: 0 for those of this process. Renderers that draw with OpenGL have one,
// because they share a device.
int DrawingThreads(const RunConfig& run, const Renderer& renderer, int cores = 0);

}  // namespace robocell::internal
