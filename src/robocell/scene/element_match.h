// Private to scene: matches the elements of two models, when a scene was compiled again with an
// object more or less.
//
// Elements are matched by name. Unnamed elements are matched by their parent and their number
// there: "the second unnamed joint of body 'door'".
#pragma once

#include <mujoco/mujoco.h>

#include <map>
#include <string>
#include <vector>

namespace robocell {

class ElementMatch {
 public:
  ElementMatch(const mjModel* from, const mjModel* to);

  const mjModel* from() const { return from_; }
  const mjModel* to() const { return to_; }
  // For each element of `to` its id in `from`, or -1. Elements whose types differ are different.
  const std::vector<int>& of(mjtObj kind) const { return ids_.at(kind); }

 private:
  const mjModel *from_, *to_;
  std::map<mjtObj, std::vector<int>> ids_;
};

}  // namespace robocell
