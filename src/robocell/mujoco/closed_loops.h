// Loops that equality constraints close: `connect` and `weld` between two branches of a tree, and
// equalities of tendons. Their joints have no polynomials (couplings.h), so positions are found by
// iteration.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "robocell/mujoco/forward.h"

namespace robocell::internal {

// A loop of hinges and slides.
struct ClosedLoop {
  int equality = -1;
  std::vector<int> joints;  // by id
};

// Returns the active loops of a model. Constraints that hold a joint of another kind are left out:
// they tie objects to a robot.
std::vector<ClosedLoop> FindClosedLoops(const mjModel* model);

// Moves the joints of loops that have a joint of the list to where their constraints are satisfied.
// Joints of the list stay where they are, as do all others where no position inside the limits is
// found near the present one; it returns false then. Joints of -1 are left out.
bool CloseLoops(const mjModel* model, std::span<const int> joints, double* qpos);

// Describes what moves a joint without an actuator: "part of the loop that 'close' closes, a connect
// of 'rod' and 'fore'"; "" if no loop has it.
std::string DescribeLoopOf(const mjModel* model, int joint);

}  // namespace robocell::internal
