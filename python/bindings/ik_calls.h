// Inverse kinematics called from Python: of a robot's arm and of a chain on its own.
#pragma once

#include "bindings.h"
#include "robocell/kinematics/ik.h"

namespace robocell::python {

// Many poses: targets (B, 4, 4), a list of poses, or one. A namespace of arrays.
nb::object BatchOf(const Chain& chain, nb::handle targets, std::span<const double> seeds,
                   const IkOptions& ik, int threads);

// All solutions (S, n).
nb::object AllSolutionsOf(const Chain& chain, const Pose& target, const IkOptions& options,
                          double separation);

// IkOptions::max_restarts for so many starts.
int RestartsOf(int starts);

}  // namespace robocell::python
