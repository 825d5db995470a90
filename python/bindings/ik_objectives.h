// Objectives of inverse kinematics beyond a pose, as Python passes them.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "bindings.h"
#include "robocell/kinematics/ik.h"

namespace robocell::python {

// Keyword arguments of `ik`, `ik_batch` and `ik_solutions`; None if not given.
struct IkObjectives {
  nb::handle position_weights, rotation_weights, axis;
  double cone = 0;
  nb::handle prefer, filter;

  // Sets them in the options, which may be used as long as the objects live, with or without the
  // GIL.
  void Apply(IkOptions* options) const;
};

// Converts a direction: "x", "y", "z" or three numbers; unset for None.
std::optional<Eigen::Vector3d> ToAxis(nb::handle axis);

// Converts at most as many values as a chain may have joints. Throws an ArgumentError that names
// them otherwise.
JointVector ToJointVector(std::span<const double> values, const char* name);

// Returns the seed of one query: empty for None. Throws ArgumentError for an empty sequence, which
// would also be empty; `ik` checks the number.
JointVector IkSeed(nb::handle seed, const Chain& chain);

// Parts of nb::sig and docstrings of functions that take objectives.
#define ROBOCELL_IK_OBJECTIVES_SIG                                           \
  "position_weights: numpy.typing.ArrayLike | None = None, "                 \
  "rotation_weights: numpy.typing.ArrayLike | None = None, "                 \
  "axis: str | numpy.typing.ArrayLike | None = None, cone: float = 0.0, "    \
  "prefer: str | numpy.typing.ArrayLike | None = None, "                     \
  "filter: collections.abc.Callable[[numpy.typing.NDArray[numpy.float64]], " \
  "numpy.typing.ArrayLike] | CollisionFilter | None = None"

// CollisionFilter.
void BindCollisionFilter(nb::module_& m);

}  // namespace robocell::python
