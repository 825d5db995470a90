// ChainSource: the numbers of a model that a chain was read from, to detect writes to them: masses,
// poses of bodies, joints and sites, limits, armature.
//
//   const Chain chain(model, "base", tip);
//   const ChainSource source(model, chain);
//   model->body_mass[hand] *= 2;
//   if (source.IsStale(model)) ... make the chain again
//
// It does not watch names and the tree, which never change in a compiled model. A check compares
// the bodies that the chain moves, 160 bytes each; no allocation.
#pragma once

#include <cstddef>
#include <vector>

#include "robocell/kinematics/chain.h"
#include "robocell/mujoco/forward.h"

namespace robocell::internal {

class ChainSource {
 public:
  ChainSource() = default;  // no chain, never stale
  ChainSource(const mjModel* model, const Chain& chain);

  // Returns true if reading the chain again may give a different one. False for any other model.
  bool IsStale(const mjModel* model) const;

 private:
  // Calls `visit(values, bytes)` with each part of the model that is read, until it returns false.
  template <class Visit>
  bool VisitParts(const mjModel* model, Visit&& visit) const;

  const mjModel* model_ = nullptr;
  // Everything that the first joint moves is contiguous in the model: its bodies, their joints, and
  // so on.
  struct Range {
    int first = 0, count = 0;
  };
  std::vector<int> fixed_;  // bodies before that
  Range bodies_, joints_, dofs_, positions_;
  Range couplings_;  // equality constraints, if joints of the chain follow others
  int site_ = -1;    // the tip, if it is a site
  std::vector<std::byte> numbers_;
};

}  // namespace robocell::internal
