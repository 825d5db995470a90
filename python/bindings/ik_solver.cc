#include "ik_solver.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "arrays.h"
#include "ik_objectives.h"
#include "signals.h"
#include "values.h"
#include "robocell/base/error.h"
#include "robocell/robot/collision_filter.h"

namespace robocell::python {
namespace {

using namespace nb::literals;

using RowMajor4 = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;

Pose ToTarget(nb::handle target) {
  if (const Pose* pose = nullptr; nb::try_cast(target, pose) && pose) return *pose;
  if (const auto matrix = MatrixOf(target, 4, 4))
    return Pose(RowMajor4(Eigen::Map<const RowMajor4>(matrix->data())));
  return nb::cast<Pose>(nb::type<Pose>()(target));
}

int Traverse(PyObject* self, visitproc visit, void* arg) {
  Py_VISIT(Py_TYPE(self));
  if (!nb::inst_ready(self)) return 0;
  Py_VISIT(nb::inst_ptr<IkSolver>(self)->filter().ptr());
  return 0;
}

int Clear(PyObject* self) {
  if (nb::inst_ready(self)) nb::inst_ptr<IkSolver>(self)->Clear();
  return 0;
}

PyType_Slot solver_slots[] = {{Py_tp_traverse, reinterpret_cast<void*>(&Traverse)},
                              {Py_tp_clear, reinterpret_cast<void*>(&Clear)},
                              {0, nullptr}};

}  // namespace

IkSolver::IkSolver(Chain chain, IkOptions options, nb::object filter)
    : chain_(std::move(chain)), options_(std::move(options)), filter_(std::move(filter)) {
  // The object is kept here, once: a copy would keep its scene alive invisibly to the collector.
  if (CollisionFilter* ready = nullptr; nb::try_cast(filter_, ready) && ready) {
    options_.filter = [ready](std::span<const double> q, int count, std::span<uint8_t> keep) {
      (*ready)(q, count, keep);
    };
  }
  options_.seed = JointVector(chain_.n_joints());  // seed of every call
  result_.q = options_.seed;
  RequireIkOptions(chain_, options_);
  is_short_ = options_.prefer == IkPrefer::kFirst && !options_.filter &&
              options_.max_restarts <= IkOptions{}.max_restarts &&
              options_.max_iterations <= IkOptions{}.max_iterations;
}

void IkSolver::Clear() {
  filter_.reset();
  options_.filter = [](std::span<const double>, int, std::span<uint8_t>) {
    throw Error("the IkSolver's filter was deleted");
  };
}

bool IkSolver::Solve(nb::handle target, nb::handle seed, nb::handle out) {
  const Pose pose = ToTarget(target);
  const JointVector start = IkSeed(seed, chain_);
  const auto n = static_cast<size_t>(chain_.n_joints());
  std::optional<std::span<double>> answer;
  if (!out.is_none()) {
    answer = WritableRowOf(out);
    if (!answer || answer->size() != n) {
      throw ArgumentError(
          fmt::format("out must be a contiguous, writable array of float64 of shape ({},)", n));
    }
  }
  options_.seed = start;
  if (is_short_) {
    result_ = Ik(chain_, pose, options_);
  } else {
    SolveForLong(pose);
  }
  if (result_.success && answer) std::copy_n(result_.q.begin(), n, answer->begin());
  return result_.success;
}

void IkSolver::SolveForLong(const Pose& target) {
  const Chain chain = chain_;
  const IkOptions options = options_;
  IkResult result;
  {
    const nb::gil_scoped_release release;
    SignalPoll poll;
    result = Ik(chain, target, options, [&] { poll(); });
  }
  result_ = result;
}

void BindIkSolver(nb::module_& m) {
  nb::class_<IkSolver>(
      m, "IkSolver",
      "Inverse kinematics with options prepared once, for loops that solve one pose after the "
      "other.\n\n`ik_solver` of a robot, its kinematics or a chain makes one; it uses the chain as "
      "it was then. Results are those of `ik` with the same options. It holds Python's lock while "
      "it solves, unless it has a filter, a preference or more restarts or iterations than the "
      "defaults.",
      nb::type_slots(solver_slots))
      .def("solve", &IkSolver::Solve, "target"_a, "seed"_a, "out"_a = nb::none(),
           nb::sig("def solve(self, target: Pose | numpy.typing.ArrayLike, seed: object, out: "
                   "numpy.typing.NDArray[numpy.float64] | None = None) -> bool"),
           "Solves `target` (in the base frame), a Pose, PyKDL.Frame or (4, 4) matrix, starting at "
           "`seed` (n,). Returns True if there is a solution.\n\nA solution is written into `out` "
           "(n,), which may be the seed; without a solution `out` does not change. Nothing is "
           "allocated for a Pose or a contiguous float64 matrix and a float64 seed."
           "\n\nExamples:\n"
           "    >>> q = np.array(robot.jnt_pos_msr)\n"
           "    >>> robot.ik_solver().solve(robot.fk_frame(q + 0.1), seed=q, out=q)\n"
           "    True")
      .def_prop_ro(
          "result", [](const IkSolver& s) { return s.result(); },
          "The IkResult of the last `solve`, a copy.")
      .def_prop_ro(
          "chain", [](const IkSolver& s) { return s.chain(); }, "A copy of the solver's chain.")
      .def("__repr__",
           [](const IkSolver& s) { return "<IkSolver of " + s.chain().description() + ">"; });
}

}  // namespace robocell::python
