// Kinematics and dynamics of one configuration or of many, as Python asks for them: what has one
// row more than a single configuration is a batch, and the rest broadcasts.
#pragma once

#include "bindings.h"
#include "robocell/kinematics/chain.h"

namespace robocell::python {

// Joint values are (n,) or (B, n): sequences, PyKDL.JntArray, or arrays, which are read where they
// are when they are contiguous and of float64. The answer is new, or written into `out` and
// returned. ValueError and TypeError name the argument.

// A Pose, or poses as (B, 4, 4).
nb::object FkOf(const Chain& chain, nb::handle q, nb::handle out);
// The poses of FkOf are written into `tips` too, unless it is None.
nb::object JacobianOf(const Chain& chain, nb::handle q, nb::handle out, nb::handle tips);
nb::object MassMatrixOf(const Chain& chain, nb::handle q, nb::handle out);
// Gravity in the base frame, (3,) or (B, 3).
nb::object GravityTorquesOf(const Chain& chain, nb::handle q, nb::handle gravity, nb::handle out);
nb::object CoriolisTorquesOf(const Chain& chain, nb::handle q, nb::handle qd, nb::handle out);
// A number, or (B,) of them.
nb::object ManipulabilityOf(const Chain& chain, nb::handle q, nb::handle out);
nb::object InverseDynamicsOf(const Chain& chain, nb::handle q, nb::handle qd, nb::handle qdd,
                             nb::handle gravity, nb::handle out);

}  // namespace robocell::python
