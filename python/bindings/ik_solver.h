// IkSolver: inverse kinematics prepared once and asked in loops. Chain and options are looked at
// when it is made, so that a call has only a pose, a seed and an array to write into.
//
// In C++ it is not needed: Ik takes options that were made before.
#pragma once

#include "bindings.h"
#include "robocell/kinematics/ik.h"

namespace robocell::python {

class IkSolver {
 public:
  // `filter` is the Python object that options.filter calls, or None. ArgumentError for options
  // that Ik refuses.
  IkSolver(Chain chain, IkOptions options, nb::object filter);

  // Solves for a pose (Pose, Frame or matrix), starting at `seed`; true when it found a solution,
  // which is then in `out`, unless that is None.
  bool Solve(nb::handle target, nb::handle seed, nb::handle out);

  const Chain& chain() const { return chain_; }
  // Of the last call; nothing found before the first.
  const IkResult& result() const { return result_; }

  const nb::object& filter() const { return filter_; }
  // For the garbage collector: afterwards the solver refuses to solve.
  void Clear();

 private:
  // Without Python's lock, on copies: other threads may ask the same solver meanwhile.
  void SolveForLong(const Pose& target);

  Chain chain_;
  IkOptions options_;
  IkResult result_;
  nb::object filter_;
  bool is_short_ = false;  // takes microseconds, tenths of a millisecond where there is no solution
};

void BindIkSolver(nb::module_& m);

// For docstrings and nb::sig of the functions that make one.
#define ROBOCELL_IK_SOLVER_DOC                                                                    \
  "Inverse kinematics with these options, prepared once for loops: an IkSolver. The options are " \
  "those of ik; seeds are given to each call."

}  // namespace robocell::python
