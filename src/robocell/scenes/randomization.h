// Randomization: draws the values of `randomize:` for one scene and puts them into its model. Each
// value comes from a stream of its own, so that pinning one changes no other.
//
//   Randomization randomization(*run.randomize, start.scene, {.place = "run 'picks'"});
//   start.randomized = randomization.Apply(Rng::Stream(run.seed, "randomize", item.index));
//
// What episodes record can be applied again without the configuration: RandomizedModel
// (scenes/randomized_model.h). Clutter belongs to the scene, and comes before it is built: DrawClutter.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/scene/scene.h"
#include "robocell/scenes/randomized_model.h"
#include "robocell/spec/randomize_config.h"
#include "robocell/spec/scene_object.h"

namespace robocell::internal {

class Randomization {
 public:
  struct Options {
    std::string place = {};      // begins messages
    std::string directory = {};  // where relative names of texture files start
  };
  Randomization(RandomizeConfig config, const Scene& scene, const Options& options);

  // Throws NotFoundError, with the targets of the scene, for a pattern that means none of them and
  // none of `others`, the objects of other starts; for a missing sky or folder of textures; and
  // ArgumentError for properties that a target lacks and for more looks than there are materials, and
  // IoError for files that are no PNG. Values are drawn for what a scene has: a
  // pattern without a target in one start of a run changes nothing there.
  void Validate(const std::vector<std::string>& others = {});

  // Draws, applies and returns the values; those of `clutter` (DrawClutter) are added. A look for
  // which no material is left is not drawn, with a warning.
  const RandomizedValues& Apply(const Rng& stream, const RandomizedValues& clutter = {});
  // Returns the values that are applied.
  const RandomizedValues& values() const { return values_; }
  void Restore() { model_.Restore(); }

 private:
  class Drawing;
  int DrawLights(Drawing& drawing) const;
  void DrawLooks(Drawing& drawing);
  void DrawDynamics(Drawing& drawing);
  void DropLooksWithoutMaterial();
  const std::vector<std::string>& TexturesOf(const std::vector<std::string>& named);

  RandomizeConfig config_;
  Options options_;
  RandomizedModel model_;
  RandomizedValues values_;
  std::map<std::vector<std::string>, std::vector<std::string>> textures_;  // words by names
};

// Returns the words to choose from: folders are replaced by their PNG files, in the order of their
// names. Throws NotFoundError, which `place` begins, for a missing file and for a folder without one.
std::vector<std::string> TextureWords(const std::vector<std::string>& named,
                                      const std::string& directory, const std::string& place);
// Returns the paths of all PNG files that textures are drawn from or pinned to.
std::vector<std::string> TextureFiles(const RandomizeConfig& config, const std::string& directory,
                                      const std::string& place);

// Objects that a start does not need, with their kinds and the values to record.
struct Clutter {
  std::vector<SceneObject> objects;  // without a pose
  std::vector<std::string> kinds;
  RandomizedValues values;
};

// Draws objects of kinds that are not among `needed`, the kinds of the task's own objects.
Clutter DrawClutter(const RandomizeConfig& config, const std::vector<std::string>& needed,
                    const Rng& stream);
// Returns the kinds that clutter can be of.
std::vector<std::string> ClutterKinds(const RandomizeConfig& config);

}  // namespace robocell::internal
