// RandomizedModel: puts values by name (spec/randomize_config.h) into a scene's model, and takes them
// out again to the bit. It knows what can be varied by name; it draws nothing (scenes/randomization.h).
//
//   RandomizedModel model(scene, run.source_dir);
//   model.Apply(values);      // {"light/0/intensity": 0.4, "cube/mass_scale": 1.2}
//   model.Restore();
//
// Names, with units:
//   light/number                        lights of the studio that shine; the scene's own are off then
//   light/I/azimuth, light/I/elevation  degrees
//   light/I/intensity, light/ambient    0 to 1
//   light/I/colour                      factors of red, green, blue
//   sky/horizon, sky/zenith             red, green, blue
//   T/colour, T/colour_scale            red, green, blue, or factors of them
//   T/specular, T/shininess, T/reflectance, each also with _scale
//   T/texture, T/texture_seed           word; whole number
//   T/mass, T/friction, T/damping, each also with _scale; T/inertia_scale, T/gain_scale
//   action_delay, clutter/...           not of the model: left to others
// T is a target: an object, a robot, or a body or geom of the scene.
//
// The scene needs a model of its own, and for looks and light/number the object `studio` (AddStudio).
// Lifetime: that of the scene's handles. Threads: those of the scene.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "robocell/mujoco/owners.h"
#include "robocell/scene/scene.h"
#include "robocell/scenes/randomized_targets.h"
#include "robocell/spec/randomize_config.h"
#include "robocell/spec/scene_spec.h"

namespace robocell::internal {

// Adds the built-in model of lights and materials that randomisation uses, unless it is there. Throws
// ArgumentError if another object has its name.
void AddStudio(SceneSpec& spec);
class StudioMaterials;
struct RandomizedLook;

class RandomizedModel {
 public:
  // `directory`: where relative names of texture files start.
  explicit RandomizedModel(const Scene& scene, std::string directory = "");
  ~RandomizedModel();
  RandomizedModel(const RandomizedModel&) = delete;
  RandomizedModel& operator=(const RandomizedModel&) = delete;

  const mjModel* model() const { return scene_.model(); }
  RandomizedTargets& targets() { return targets_; }
  // Returns the number of the scene's own lights.
  int own_lights() const;
  bool has_sky() const;

  enum class Part { kAll, kPhysics };  // physics: what a replay of controls depends on
  // Returns those of `targets` for whose materials the studio has no room when looks other than
  // colour are given to all of them, in the order of their names.
  std::vector<std::string> WithoutMaterials(std::vector<std::string> targets);

  // Restores, and then applies. The state stays; quantities that follow from it are computed anew.
  // Throws Error if objects were added or removed since the last values were applied.
  // Throws NotFoundError for names of nothing, ArgumentError for values of a wrong form and for more
  // looks than the studio has materials, and Error for a frozen model.
  void Apply(const RandomizedValues& values, Part part = Part::kAll);
  // Makes the model as it was before Apply, which the destructor does too. Does nothing without one,
  // or if objects were added or removed since.
  void Restore();

 private:
  struct Saved {
    void* at;
    std::vector<std::byte> bytes;
  };
  void KeepBytes(void* at, size_t bytes);
  template <class T>
  void Keep(T* at, int64_t count) {
    KeepBytes(at, static_cast<size_t>(count) * sizeof(T));
  }
  void KeepAll();
  void ApplyLights(const RandomizedValues& values);
  void ApplySky(const RandomizedValues& values);
  void ApplyLook(const RandomizedTarget& target, const RandomizedLook& look,
                 StudioMaterials& studio);
  void ApplyPhysics(const RandomizedTarget& target, std::string_view property,
                    const RandomizedValue& value, const std::string& name);
  void RecomputeConstants();
  std::string place() const;

  Scene scene_;
  std::string directory_;
  uint64_t generation_ = 0;
  RandomizedTargets targets_;
  std::vector<Saved> saved_;  // of an Apply, in `generation_`
  bool textures_differ_ = false;
  bool inertia_differs_ = false;
  DataPtr scratch_;
};

// Copies all that RandomizedModel changes of the look of a model to a copy of that model. Returns
// true if textures changed.
bool CopyLooks(const mjModel* from, mjModel* to);

}  // namespace robocell::internal
