#include "robocell/scenes/scene_source.h"

#include "robocell/assets/resolve.h"

namespace robocell {

SceneSpec MakeBaseScene(const RunConfig& run, int scene_index) {
  SceneSpec spec;
  spec.name = run.run;
  spec.timestep = run.rates.timestep().value();
  spec.options = run.options;
  if (run.scenes.kind() == SceneSourceKind::kFiles) {
    const std::string& file = run.scenes.files.at(static_cast<size_t>(scene_index));
    spec.base = assets::Resolve(file, run.scenes.root.value_or(run.source_dir));
  } else {
    spec.base = "tabletop";
    spec.add_floor = true;
    spec.add_skybox = true;
  }
  return spec;
}

}  // namespace robocell
