// Kinematics of a robot's arm: forward kinematics, Jacobian, inverse kinematics for one pose and
// for batches.
#include "kinematics.h"

#include <fmt/format.h>
#include <nanobind/nanobind.h>

#include "arrays.h"
#include "bindings.h"
#include "chain_batch.h"
#include "closed_handles.h"
#include "signals.h"
#include "robocell/kinematics/ik_batch.h"

namespace nb = nanobind;

namespace robocell::python {

using namespace nb::literals;

namespace {

IkResult SolveIk(const Kinematics& k, const PoseOrFrame& target, nb::handle seed,
                 const std::vector<std::string>& locked_groups, double tolerance,
                 bool position_only, bool prefer_near_seed, int max_restarts, int max_iterations) {
  IkOptions options{.tolerance = tolerance,
                    .position_only = position_only,
                    .prefer_near_seed = prefer_near_seed,
                    .max_restarts = max_restarts,
                    .max_iterations = max_iterations};
  if (!seed.is_none()) options.seed = JointVector(std::span<const double>(ToRow(seed, "seed")));
  options.locked = k.robot.LockGroups(locked_groups);
  const Pose pose = target.get();
  const nb::gil_scoped_release release;
  return k.robot.Ik(pose, options);
}

// A Pose, a Frame, or something with four rows.
bool IsOnePose(nb::handle value) {
  if (nb::isinstance<Pose>(value) || nb::hasattr(value, "M")) return true;
  if (!MayBePose(value) || nb::len(value) != 4) return false;
  return MayBePose(nb::object(value[0])) && nb::len(nb::object(value[0])) == 4;
}

// (B, 4, 4), a list of poses, or one.
std::vector<Pose> ToPoses(nb::handle targets) {
  if (const Pose* one = nullptr; nb::try_cast(targets, one) && one) return {*one};
  const bool is_list = nb::isinstance<nb::list>(targets) || nb::isinstance<nb::tuple>(targets);
  if (!is_list || nb::len(targets) == 0 || !IsOnePose(nb::object(targets[0])))
    return PosesFromMatrices(ToDoubles(targets, "targets"), "targets");
  std::vector<Pose> poses;
  for (const nb::handle item : targets) {
    try {
      poses.push_back(nb::cast<Pose>(nb::type<Pose>()(item)));
    } catch (const nb::python_error& error) {
      throw ArgumentError(fmt::format("targets[{}]: {}", poses.size(),
                                      nb::cast<std::string>(nb::str(error.value()))));
    }
  }
  return poses;
}

nb::object SolveBatch(const Kinematics& k, nb::handle targets, nb::handle seeds,
                      const std::vector<std::string>& locked_groups, double tolerance, int threads,
                      bool position_only, bool prefer_near_seed, int max_restarts,
                      int max_iterations) {
  const std::vector<Pose> poses = ToPoses(targets);
  std::vector<double> seed_values;
  if (!seeds.is_none()) {
    seed_values = ToDoubles(seeds, "seeds");
  } else if (!locked_groups.empty()) {
    seed_values = k.robot.arm().joint_pos();
  }
  const LockedJoints locked = k.robot.LockGroups(locked_groups);
  IkBatchResult result;
  {
    const nb::gil_scoped_release release;
    SignalPoll poll;
    const IkBatchOptions options{.ik = {.tolerance = tolerance,
                                        .locked = locked,
                                        .position_only = position_only,
                                        .prefer_near_seed = prefer_near_seed,
                                        .max_restarts = max_restarts,
                                        .max_iterations = max_iterations},
                                 .threads = threads,
                                 .poll = [&] { poll(); }};
    result = IkBatch(k.robot.chain(), poses, seed_values, options);
  }
  const size_t b = static_cast<size_t>(result.size), n = static_cast<size_t>(result.n_joints);
  nb::object make = nb::module_::import_("types").attr("SimpleNamespace");
  const nb::object numpy = nb::module_::import_("numpy");
  return make(
      "q"_a = NewArray<double>(result.q, {b, n}),
      "success"_a = NewArray<uint8_t>(result.success, {b}).attr("astype")(numpy.attr("bool_")),
      "position_error"_a = NewArray<double>(result.position_error, {b}),
      "rotation_error"_a = NewArray<double>(result.rotation_error, {b}),
      "iterations"_a = NewArray<int>(result.iterations, {b}));
}

// The world's, in the axes of the robot base frame, unless given.
nb::object GravityFor(const Kinematics& k, nb::handle gravity) {
  if (!gravity.is_none()) return nb::borrow(gravity);
  const Eigen::Vector3d g = k.robot.gravity_in_base();
  return nb::make_tuple(g.x(), g.y(), g.z());
}

void DefDynamics(nb::class_<Kinematics>& c) {
  c.def(
       "fk",
       [](const Kinematics& k, nb::handle q, nb::handle out) {
         return FkOf(k.robot.chain(), q, out);
       },
       "q"_a, "out"_a = nb::none(),
       nb::sig("def fk(self, q: object, out: numpy.typing.NDArray[numpy.float64] | None = None) -> "
               "typing.Any"),
       "Pose of the TCP in the robot base frame for joint values q (n,); of a batch (B, n), "
       "(B, 4, 4) matrices.")
      .def(
          "jacobian",
          [](const Kinematics& k, nb::handle q, nb::handle out) {
            return JacobianOf(k.robot.chain(), q, out);
          },
          "q"_a, "out"_a = nb::none(),
          nb::sig("def jacobian(self, q: object, out: numpy.typing.NDArray[numpy.float64] | None = "
                  "None) -> numpy.typing.NDArray[numpy.float64]"),
          "(6, n) at the TCP, axes of the robot base frame, linear rows first.")
      .def(
          "gravity_torques",
          [](const Kinematics& k, nb::handle q, nb::handle gravity, nb::handle out) {
            return GravityTorquesOf(k.robot.chain(), q, GravityFor(k, gravity), out);
          },
          "q"_a, "gravity"_a = nb::none(), "out"_a = nb::none(),
          nb::sig("def gravity_torques(self, q: object, gravity: numpy.typing.ArrayLike | None = "
                  "None, out: numpy.typing.NDArray[numpy.float64] | None = None) -> "
                  "numpy.typing.NDArray[numpy.float64]"),
          "Torques (n,) that hold the arm still at q. `gravity`, (3,) m/s^2 in the axes of the "
          "robot base frame, is the scene's unless given.")
      .def(
          "mass_matrix",
          [](const Kinematics& k, nb::handle q, nb::handle out) {
            return MassMatrixOf(k.robot.chain(), q, out);
          },
          "q"_a, "out"_a = nb::none(),
          nb::sig("def mass_matrix(self, q: object, out: numpy.typing.NDArray[numpy.float64] | "
                  "None = None) -> numpy.typing.NDArray[numpy.float64]"),
          "(n, n) joint-space inertia with armature.")
      .def(
          "inverse_dynamics",
          [](const Kinematics& k, nb::handle q, nb::handle qd, nb::handle qdd, nb::handle gravity,
             nb::handle out) {
            return InverseDynamicsOf(k.robot.chain(), q, qd, qdd, GravityFor(k, gravity), out);
          },
          "q"_a, "qd"_a, "qdd"_a, "gravity"_a = nb::none(), "out"_a = nb::none(),
          nb::sig("def inverse_dynamics(self, q: object, qd: object, qdd: object, gravity: "
                  "numpy.typing.ArrayLike | None = None, out: numpy.typing.NDArray[numpy.float64] "
                  "| None = None) -> numpy.typing.NDArray[numpy.float64]"),
          "Torques (n,) for a motion, gravity and armature included; no friction, damping or "
          "contact.");
}

}  // namespace

bool MayBePose(nb::handle value) noexcept {
  if (nb::hasattr(value, "M") && nb::hasattr(value, "p")) return true;
  if (!PySequence_Check(value.ptr()) || PyUnicode_Check(value.ptr())) return false;
  const bool has_length = PySequence_Size(value.ptr()) >= 0;  // not so an array without dimensions
  PyErr_Clear();
  return has_length;
}

void BindKinematics(nb::module_& m) {
  nb::class_<IkResult>(
      m, "IkResult",
      "The answer of inverse kinematics; not finding a solution is a value, no exception.")
      .def_prop_ro(
          "q",
          [](const IkResult& r) {
            return NewArray<double>(std::span(r.q.data(), static_cast<size_t>(r.q.size())),
                                    {static_cast<size_t>(r.q.size())});
          },
          nb::for_getter(nb::sig("def q(self) -> numpy.typing.NDArray[numpy.float64]")),
          "Joint values in chain order, rad or m; the best met when there is no solution.")
      .def_ro("success", &IkResult::success)
      .def_ro("position_error", &IkResult::position_error, "Metres.")
      .def_ro("rotation_error", &IkResult::rotation_error, "Radians.")
      .def_ro("iterations", &IkResult::iterations,
              "Steps; those that lanes take at once count as one.")
      .def_ro("restarts", &IkResult::restarts, "Starts before the one that led to q.")
      .def("__bool__", [](const IkResult& r) { return r.success; })
      .def("__repr__", [](const IkResult& r) {
        return "<IkResult " + std::string(r.success ? "success" : "no solution") + ", " +
               std::to_string(r.position_error) + " m, " + std::to_string(r.rotation_error) +
               " rad>";
      });
  BindChain(m);
  nb::class_<Kinematics> kinematics(
      m, "Kinematics",
      "Kinematics of a robot's arm, from the robot base frame to the TCP.\n\nWhat takes "
      "joint values q (n,) takes many at once, (B, n), and answers with B in front of the shape; "
      "arguments with one row are for all. Arrays that are contiguous and of float64 are read "
      "where they are, and the answer is written into `out` when it is given. No result depends "
      "on the batch that it is in.");
  GuardHandle<Kinematics>(kinematics, [](const Kinematics& k) { k.robot.RequireOpen(); });
  DefDynamics(kinematics);
  kinematics
      .def_prop_ro("joint_names", [](const Kinematics& k) { return k.robot.chain().joint_names(); })
      .def("ik", &SolveIk, "target"_a, "seed"_a = nb::none(),
           "locked_groups"_a = std::vector<std::string>{}, "tolerance"_a = 1e-5,
           "position_only"_a = false, "prefer_near_seed"_a = false, "max_restarts"_a = 100,
           "max_iterations"_a = 40,
           "Joint values that put the TCP at `target` (in the robot base frame): a Pose, a "
           "PyKDL.Frame or a 4x4 matrix. Starts at `seed`, else where the arm is.\n\n"
           "The joints of `locked_groups` stay where the seed has them. "
           "Limits are always obeyed; the same question has the same answer. Damped least squares "
           "(Sugihara 2011) with\n"
           "evenly spread restarts.")
      .def("ik_batch", &SolveBatch, "targets"_a, "seeds"_a = nb::none(),
           "locked_groups"_a = std::vector<std::string>{}, "tolerance"_a = 1e-5, "threads"_a = 1,
           "position_only"_a = false, "prefer_near_seed"_a = false, "max_restarts"_a = 100,
           "max_iterations"_a = 40,
           nb::sig("def ik_batch(self, targets: object, seeds: object | None = None, "
                   "locked_groups: collections.abc.Sequence[str] = [], tolerance: float = 1e-05, "
                   "threads: int = 1, position_only: bool = False, prefer_near_seed: bool = False, "
                   "max_restarts: int = 100, max_iterations: int = 40) -> types.SimpleNamespace"),
           "Many poses at once, as many at a time as the processor has lanes.\n\n"
           "targets (B, 4, 4) in the robot base frame, or a list of poses. seeds (B, n) or (n,): "
           "where each search "
           "begins, and where the joints of `locked_groups` stay; without seeds it begins near "
           "the target (joints of locked groups stay where the robot has them). Returns q (B, n), "
           "success (B,), position_error (B,) in m, rotation_error (B,) in rad and iterations "
           "(B,). Limits are always obeyed. An answer does not depend on the batch it is in; "
           "processors with other instruction sets may find another solution.")
      .def_prop_ro(
          "reach", [](const Kinematics& k) { return k.robot.reach(); },
          nb::call_guard<nb::gil_scoped_release>(),
          "Farthest the TCP gets from the root body, metres.");
}

}  // namespace robocell::python
