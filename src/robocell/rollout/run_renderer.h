// The renderer of a run's images. A run that leaves the back end open ("auto") draws with the one
// that its dataset was begun with, on every machine, so that a dataset has images of one making.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "robocell/render/renderer.h"
#include "robocell/spec/run_config.h"

namespace robocell::internal {

// The name of the back end: what the run says, else what its dataset was begun with, else "auto".
std::string BackendOf(const RunConfig& run);

// What a dataset is begun with. Of one that has episodes it is the back end that drew these.
// "" for runs without cameras.
std::string BackendToBeginWith(const RunConfig& run);

// Throws Error when the dataset's back end does not work here. Other errors are MakeRenderer's.
std::unique_ptr<Renderer> MakeRendererOf(const RunConfig& run, const Visibility& visibility = {});

}  // namespace robocell::internal
