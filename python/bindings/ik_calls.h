// Inverse kinematics called from Python: of a robot's arm and of a chain alone.
#pragma once

#include "bindings.h"
#include "robocell/kinematics/differential_ik.h"
#include "robocell/kinematics/ik.h"

namespace robocell::python {

// Solves many poses: targets (B, 4, 4), a list of poses, or one. Returns a namespace of arrays.
nb::object BatchOf(const Chain& chain, nb::handle targets, std::span<const double> seeds,
                   const IkOptions& ik, int threads);

// Returns the seeds of a batch, one (n,) or many (B, n), row by row; empty for None. Throws
// ArgumentError for other shapes.
std::vector<double> SeedsOf(const Chain& chain, nb::handle seeds);

// Returns all solutions (S, n).
nb::object AllSolutionsOf(const Chain& chain, const Pose& target, const IkOptions& options,
                          double separation);

// Returns IkOptions::max_restarts for this number of starts.
int RestartsOf(int starts);

// The base's rotation for twists in world axes, and the locked joints.
struct TwistPlace {
  Eigen::Matrix3d base_in_world = Eigen::Matrix3d::Identity();
  LockedJoints locked{};
};

// Differential inverse kinematics; None means not given. Returns a namespace of `velocity`, `twist`
// and `slower`.
nb::object TwistOf(const Chain& chain, nb::handle q, nb::handle twist, nb::handle frame,
                   double seconds, nb::handle max_speed, nb::handle posture, double posture_rate,
                   const TwistPlace& place);

// Returns a reach map between two corners, as a namespace of arrays.
nb::object ReachMapOf(const Chain& chain, nb::handle lower, nb::handle upper, double cell,
                      int rotations, double tolerance, int max_restarts, int threads,
                      bool position_only, nb::handle axis);
// Returns the corners of a box around everything in reach.
nb::object ReachBoxOf(const Chain& chain);

#define ROBOCELL_REACH_MAP_ARGS                                                    \
  "lower"_a, "upper"_a, "cell"_a = 0.05, "rotations"_a = 64, "tolerance"_a = 1e-3, \
                        "max_restarts"_a = 4, "threads"_a = 1, nb::kw_only(),      \
                        "position_only"_a = false, "axis"_a = nb::none()
// The part of nb::sig after the first arguments.
#define ROBOCELL_REACH_MAP_SIG                                                                     \
  "lower: numpy.typing.ArrayLike, upper: numpy.typing.ArrayLike, cell: float = "                   \
  "0.05, rotations: int = 64, tolerance: float = 0.001, max_restarts: int = 4, "                   \
  "threads: int = 1, *, position_only: bool = False, axis: str | numpy.typing.ArrayLike | None = " \
  "None) "                                                                                         \
  "-> types.SimpleNamespace"
#define ROBOCELL_REACH_BOX_SIG                                         \
  "def reach_box(self) -> tuple[numpy.typing.NDArray[numpy.float64], " \
  "numpy.typing.NDArray[numpy.float64]]"

}  // namespace robocell::python
