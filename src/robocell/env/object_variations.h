// ObjectVariations: masses, frictions and colours of objects that differ from episode to episode.
// It writes to the model, so the scene needs its own copy of the model.
//
//   ObjectVariations variations(config, scene);
//   variations.Draw(rng);                          // at each reset
//   const std::vector<double> drawn = variations.drawn();
//   variations.Apply(drawn);                       // the same again
#pragma once

#include <span>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/mujoco/owners.h"
#include "robocell/scene/scene.h"
#include "robocell/spec/env_config.h"

namespace robocell::internal {

class ObjectVariations {
 public:
  ObjectVariations(const EnvConfig& config, Scene scene);

  // Throws Error if the model is frozen and there is something to draw.
  void Draw(Rng& rng);
  // Returns for each object the factors of mass and friction, and the offsets of red, green and
  // blue.
  const std::vector<double>& drawn() const { return drawn_; }
  // Throws ArgumentError for a wrong number of values.
  void Apply(std::span<const double> drawn);

 private:
  static constexpr size_t kNumbers = 5;

  // The original values of an object in the model.
  struct Varied {
    ObjectVariation range;
    std::vector<int> bodies, geoms;
    std::vector<double> mass, inertia, friction;
    std::vector<float> rgba;
  };
  void Bind();
  Varied Read(const std::string& object, const ObjectVariation& range) const;
  void Write(const Varied& object, std::span<const double> drawn);

  std::vector<std::pair<std::string, ObjectVariation>> ranges_;
  Scene scene_;
  uint64_t generation_ = 0;
  std::vector<Varied> objects_;
  DataPtr scratch_;
  std::vector<double> drawn_;
};

}  // namespace robocell::internal
