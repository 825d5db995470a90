// IkSolver: inverse kinematics prepared once for calls in loops. Its constructor checks chain and
// options, so that a call has only a pose, a seed and an array to write into.
//
// C++ does not need it: Ik takes options that were made before.
#pragma once

#include "bindings.h"
#include "robocell/kinematics/ik.h"

namespace robocell::python {

class IkSolver {
 public:
  // `filter` is the Python object that options.filter calls, or None. Throws ArgumentError for
  // options that Ik rejects.
  IkSolver(Chain chain, IkOptions options, nb::object filter);

  // Solves for a pose (Pose, Frame or matrix), starting at `seed`. Returns true if it found a
  // solution, and writes it into `out`, unless that is None.
  bool Solve(nb::handle target, nb::handle seed, nb::handle out);

  const Chain& chain() const { return chain_; }
  // Returns the result of the last call; a failed one before the first.
  const IkResult& result() const { return result_; }

  const nb::object& filter() const { return filter_; }
  // Drops the references for the garbage collector; afterwards the solver refuses to solve.
  void Clear();

 private:
  // Runs without Python's lock, on copies: other threads may use the same solver meanwhile.
  void SolveForLong(const Pose& target);

  Chain chain_;
  IkOptions options_;
  IkResult result_;
  nb::object filter_;
  bool is_short_ = false;  // microseconds; tenths of a millisecond without a solution
};

void BindIkSolver(nb::module_& m);

// Docstring and nb::sig of the functions that make a solver.
#define ROBOCELL_IK_SOLVER_DOC                                                                    \
  "Returns an IkSolver that is prepared with these options, for loops. The options are those of " \
  "ik; seeds are given to each call."

}  // namespace robocell::python
