// Kinematics and dynamics of one configuration or of many, called from Python: an argument with one
// dimension more than a single configuration is a batch, and the rest broadcasts.
#pragma once

#include "bindings.h"
#include "robocell/kinematics/chain.h"

namespace robocell::python {

// Joint values are (n,) or (B, n): sequences, PyKDL.JntArray, or arrays, which are read in place if
// they are contiguous float64. The result is new, or written into `out` and returned. Raises
// ValueError and TypeError that name the argument.

// Returns a Pose, or poses as (B, 4, 4).
nb::object FkOf(const Chain& chain, nb::handle q, nb::handle out);
// Returns Jacobians, and writes the poses of FkOf into `tips`, unless it is None.
nb::object JacobianOf(const Chain& chain, nb::handle q, nb::handle out, nb::handle tips);
nb::object MassMatrixOf(const Chain& chain, nb::handle q, nb::handle out);
// Gravity is in the base frame, (3,) or (B, 3).
nb::object GravityTorquesOf(const Chain& chain, nb::handle q, nb::handle gravity, nb::handle out);
nb::object CoriolisTorquesOf(const Chain& chain, nb::handle q, nb::handle qd, nb::handle out);
// Returns a number, or (B,) numbers.
nb::object ManipulabilityOf(const Chain& chain, nb::handle q, nb::handle out);
nb::object InverseDynamicsOf(const Chain& chain, nb::handle q, nb::handle qd, nb::handle qdd,
                             nb::handle gravity, nb::handle out);

}  // namespace robocell::python
