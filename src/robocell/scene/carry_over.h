// Private to scene: the state that a scene keeps when it is compiled again after an object was
// added or removed.
//
// This includes all that mj_recompile would lose: applied forces, warm starts, switched equalities,
// user data, buffers of delays, states of plugins, the engine's counts of warnings.
#pragma once

#include <mujoco/mujoco.h>

#include <map>
#include <string>
#include <vector>

namespace robocell::internal {

// Matches the elements of the two models: by name, and unnamed ones by their parent and their
// number there: "the second unnamed joint of body 'door'".
class ElementMatch {
 public:
  ElementMatch(const mjModel* from, const mjModel* to);

  const mjModel* from() const { return from_; }
  const mjModel* to() const { return to_; }
  // Returns, for each element of `to`, its id in `from`, or -1. Elements whose types differ are
  // different.
  const std::vector<int>& of(mjtObj kind) const { return ids_.at(kind); }

 private:
  const mjModel *from_, *to_;
  std::map<mjtObj, std::vector<int>> ids_;
};

// Copies the time and the state of everything that is in both models. New elements keep their state
// in `to`.
void CarryState(const ElementMatch& match, const mjData* from, mjData* to);

// Copies the values that were written to the model while it was simulated: options, the actuators
// that are switched off (control modes), and the real numbers and contact masks of everything that
// is in both models: of bodies, joints, geoms, sites, cameras, lights, materials, contact pairs,
// equalities, tendons, actuators and sensors. Masses of subtrees are summed again. All other fields
// are those of `to`: what the engine derives from the whole model, other integers and flags, user
// numbers, numerics, keyframes, tendons' wraps, flexes, skins, meshes, height fields and textures.
void CarryModel(const ElementMatch& match, mjModel* to);

}  // namespace robocell::internal
