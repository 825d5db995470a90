// Kinematics of a robot's arm: forward kinematics, Jacobian, inverse kinematics for one pose and
// for batches.
#include "kinematics.h"

#include <fmt/format.h>
#include <nanobind/nanobind.h>

#include <array>
#include <utility>

#include "arrays.h"
#include "bindings.h"
#include "chain_batch.h"
#include "handles.h"
#include "ik_calls.h"
#include "ik_objectives.h"
#include "ik_solver.h"
#include "scene_cycles.h"
#include "signals.h"
#include "values.h"
#include "robocell/base/error.h"
#include "robocell/base/names.h"

namespace nb = nanobind;

namespace robocell::python {

using namespace nb::literals;

namespace {

constexpr std::array kTwistFrames = {std::pair{TwistFrame::kBase, "base"},
                                     std::pair{TwistFrame::kTip, "tip"},
                                     std::pair{TwistFrame::kWorld, "world"}};

int VisitKinematics(const Kinematics& k, visitproc visit, void* arg) {
  return VisitScene(k.robot.scene(), visit, arg);
}

const Robot& RobotOf(const Robot& robot) { return robot; }
const Robot& RobotOf(const Kinematics& k) { return k.robot; }

IkOptions OptionsFor(const Robot& robot, nb::handle seed,
                     const std::vector<std::string>& locked_groups,
                     const IkObjectives& objectives) {
  IkOptions options;
  options.seed = IkSeed(seed, robot.chain());
  options.locked = robot.LockGroups(locked_groups);
  objectives.Apply(&options);
  return options;
}

// Where no seed is given, the arm's own position is one.
void StartAtTheArm(const Robot& robot, IkOptions* options) {
  if (options->seed.empty()) options->seed = JointVector(robot.arm().joint_pos());
}

// The chain as it is now, for work without Python's lock: another thread may reset the scene or add
// objects meanwhile, which makes the robot's anew.
Chain SteadyChain(const Robot& robot) { return robot.chain(); }

// Of a robot, or of its kinematics.
template <class Self>
IkResult SolveIk(const Self& self, const PoseOrFrame& target, nb::handle seed,
                 const std::vector<std::string>& locked_groups, double tolerance,
                 bool position_only, int max_restarts, int max_iterations,
                 nb::handle position_weights, nb::handle rotation_weights, nb::handle axis,
                 double cone, nb::handle prefer, nb::handle filter) {
  const Robot& robot = RobotOf(self);
  IkOptions options = OptionsFor(robot, seed, locked_groups,
                                 {position_weights, rotation_weights, axis, cone, prefer, filter});
  options.tolerance = tolerance;
  options.position_only = position_only;
  options.max_restarts = max_restarts;
  options.max_iterations = max_iterations;
  StartAtTheArm(robot, &options);
  const Pose pose = target.get();
  const Chain chain = SteadyChain(robot);
  const nb::gil_scoped_release release;
  SignalPoll poll;
  return Ik(chain, pose, options, [&] { poll(); });
}

template <class Self>
IkSolver MakeSolver(const Self& self, const std::vector<std::string>& locked_groups,
                    double tolerance, bool position_only, int max_restarts, int max_iterations,
                    nb::handle position_weights, nb::handle rotation_weights, nb::handle axis,
                    double cone, nb::handle prefer, nb::handle filter) {
  const Robot& robot = RobotOf(self);
  IkOptions options = OptionsFor(robot, nb::none(), locked_groups,
                                 {position_weights, rotation_weights, axis, cone, prefer, filter});
  options.tolerance = tolerance;
  options.position_only = position_only;
  options.max_restarts = max_restarts;
  options.max_iterations = max_iterations;
  return IkSolver(SteadyChain(robot), std::move(options), nb::borrow(filter));
}

nb::object SolveAll(const Kinematics& k, const PoseOrFrame& target, nb::handle seed,
                    const std::vector<std::string>& locked_groups, double tolerance,
                    bool position_only, int starts, double separation, nb::handle position_weights,
                    nb::handle rotation_weights, nb::handle axis, double cone, nb::handle prefer,
                    nb::handle filter) {
  IkOptions options = OptionsFor(k.robot, seed, locked_groups,
                                 {position_weights, rotation_weights, axis, cone, prefer, filter});
  StartAtTheArm(k.robot, &options);
  options.tolerance = tolerance;
  options.position_only = position_only;
  options.max_restarts = RestartsOf(starts);
  return AllSolutionsOf(SteadyChain(k.robot), target.get(), options, separation);
}

nb::object SolveBatch(const Kinematics& k, nb::handle targets, nb::handle seeds,
                      const std::vector<std::string>& locked_groups, double tolerance, int threads,
                      bool position_only, int max_restarts, int max_iterations,
                      nb::handle position_weights, nb::handle rotation_weights, nb::handle axis,
                      double cone, nb::handle prefer, nb::handle filter) {
  IkOptions ik = OptionsFor(k.robot, nb::none(), locked_groups,
                            {position_weights, rotation_weights, axis, cone, prefer, filter});
  ik.tolerance = tolerance;
  ik.position_only = position_only;
  ik.max_restarts = max_restarts;
  ik.max_iterations = max_iterations;
  std::vector<double> seed_values;
  if (!seeds.is_none()) {
    seed_values = SeedsOf(SteadyChain(k.robot), seeds);
  } else if (!locked_groups.empty() || ik.prefer == IkPrefer::kSeed) {
    seed_values = k.robot.arm().joint_pos();
  }
  return BatchOf(SteadyChain(k.robot), targets, seed_values, ik, threads);
}

nb::object SolveTwist(const Kinematics& k, nb::handle q, nb::handle twist, nb::handle frame,
                      double seconds, nb::handle max_speed, nb::handle posture, double posture_rate,
                      const std::vector<std::string>& locked_groups) {
  const TwistPlace place{.base_in_world = k.robot.base_in_world().rotation(),
                         .locked = k.robot.LockGroups(locked_groups)};
  return TwistOf(SteadyChain(k.robot), q, twist, frame, seconds, max_speed, posture, posture_rate,
                 place);
}

nb::object MapReachOf(const Kinematics& k, nb::handle lower, nb::handle upper, double cell,
                      int rotations, double tolerance, int max_restarts, int threads,
                      bool position_only, nb::handle axis) {
  return ReachMapOf(SteadyChain(k.robot), lower, upper, cell, rotations, tolerance, max_restarts,
                    threads, position_only, axis);
}

// Threads may share kinematics while the scene rests, so that they claim nothing: they look at
// where the robot is, and work on the chain that it has.
void RequireRest(const Kinematics& k) {
  if (!k.robot.use().by_another_thread()) return;
  throw Error(fmt::format(
      "kinematics of robot '{}': its scene '{}' is in use by another thread, and may be moving it. "
      "In other threads use robot.chain, a copy with the same functions, taken beforehand; or let "
      "the threads take turns with a lock of yours",
      k.robot.name(), k.robot.scene().name()));
}

// The world's, in the axes of the robot base frame, unless given.
nb::object GravityFor(const Kinematics& k, nb::handle gravity) {
  if (!gravity.is_none()) return nb::borrow(gravity);
  const Eigen::Vector3d g = k.robot.gravity_in_base();
  return nb::make_tuple(g.x(), g.y(), g.z());
}

// After the target.
#define ROBOCELL_IK_ARGS                                                                       \
  "seed"_a = nb::none(), "locked_groups"_a = std::vector<std::string>{}, "tolerance"_a = 1e-5, \
  "position_only"_a = false, "max_restarts"_a = 100, "max_iterations"_a = 40, nb::kw_only(),   \
  "position_weights"_a = nb::none(), "rotation_weights"_a = nb::none(), "axis"_a = nb::none(), \
  "cone"_a = 0.0, "prefer"_a = nb::none(), "filter"_a = nb::none()
#define ROBOCELL_IK_SOLVER_ARGS                                                                    \
  "locked_groups"_a = std::vector<std::string>{}, "tolerance"_a = 1e-5, "position_only"_a = false, \
  "max_restarts"_a = 100, "max_iterations"_a = 40, nb::kw_only(),                                  \
  "position_weights"_a = nb::none(), "rotation_weights"_a = nb::none(), "axis"_a = nb::none(),     \
  "cone"_a = 0.0, "prefer"_a = nb::none(), "filter"_a = nb::none()
#define ROBOCELL_IK_SOLVER_SIG                                                               \
  "def ik_solver(self, locked_groups: collections.abc.Sequence[str] = [], tolerance: float " \
  "= 1e-05, position_only: bool = False, max_restarts: int = 100, max_iterations: int = "    \
  "40, *, " ROBOCELL_IK_OBJECTIVES_SIG ") -> IkSolver"
#define ROBOCELL_IK_SIG                                                                      \
  "Pose | numpy.typing.ArrayLike, seed: object | None = None, locked_groups: "               \
  "collections.abc.Sequence[str] = [], tolerance: float = 1e-05, position_only: bool = "     \
  "False, max_restarts: int = 100, max_iterations: int = 40, *, " ROBOCELL_IK_OBJECTIVES_SIG \
  ") -> IkResult"

void DefDynamics(nb::class_<Kinematics>& c) {
  c.def(
       "fk",
       [](const Kinematics& k, nb::handle q, nb::handle out) {
         return FkOf(SteadyChain(k.robot), q, out);
       },
       "q"_a, "out"_a = nb::none(),
       nb::sig("def fk(self, q: object, out: numpy.typing.NDArray[numpy.float64] | None = None) -> "
               "typing.Any"),
       "Pose of the TCP in the robot base frame for joint values q (n,); of a batch (B, n), "
       "(B, 4, 4) matrices.")
      .def(
          "jacobian",
          [](const Kinematics& k, nb::handle q, nb::handle out, nb::handle tips) {
            return JacobianOf(SteadyChain(k.robot), q, out, tips);
          },
          "q"_a, "out"_a = nb::none(), "tips"_a = nb::none(),
          nb::sig("def jacobian(self, q: object, out: numpy.typing.NDArray[numpy.float64] | None = "
                  "None, tips: numpy.typing.NDArray[numpy.float64] | None = None) -> "
                  "numpy.typing.NDArray[numpy.float64]"),
          "(6, n) at the TCP, axes of the robot base frame, linear rows first. The poses of fk are "
          "written into `tips` too, (4, 4) or (B, 4, 4), if it is given: faster than both calls.")
      .def(
          "gravity_torques",
          [](const Kinematics& k, nb::handle q, nb::handle gravity, nb::handle out) {
            return GravityTorquesOf(SteadyChain(k.robot), q, GravityFor(k, gravity), out);
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
            return MassMatrixOf(SteadyChain(k.robot), q, out);
          },
          "q"_a, "out"_a = nb::none(),
          nb::sig("def mass_matrix(self, q: object, out: numpy.typing.NDArray[numpy.float64] | "
                  "None = None) -> numpy.typing.NDArray[numpy.float64]"),
          "(n, n) joint-space inertia with armature, that of fixed tendons included.")
      .def(
          "coriolis_torques",
          [](const Kinematics& k, nb::handle q, nb::handle qd, nb::handle out) {
            return CoriolisTorquesOf(SteadyChain(k.robot), q, qd, out);
          },
          "q"_a, "qd"_a, "out"_a = nb::none(),
          nb::sig("def coriolis_torques(self, q: object, qd: object, out: "
                  "numpy.typing.NDArray[numpy.float64] | None = None) -> "
                  "numpy.typing.NDArray[numpy.float64]"),
          "The part of the torques (n,) that comes from moving at `qd`.")
      .def(
          "inverse_dynamics",
          [](const Kinematics& k, nb::handle q, nb::handle qd, nb::handle qdd, nb::handle gravity,
             nb::handle out) {
            return InverseDynamicsOf(SteadyChain(k.robot), q, qd, qdd, GravityFor(k, gravity), out);
          },
          "q"_a, "qd"_a, "qdd"_a, "gravity"_a = nb::none(), "out"_a = nb::none(),
          nb::sig("def inverse_dynamics(self, q: object, qd: object, qdd: object, gravity: "
                  "numpy.typing.ArrayLike | None = None, out: numpy.typing.NDArray[numpy.float64] "
                  "| None = None) -> numpy.typing.NDArray[numpy.float64]"),
          "Torques (n,) for a motion, gravity and armature included; no friction, damping or "
          "contact.");
}

}  // namespace

void DefRobotIk(nb::class_<Robot>& robot) {
  robot.def("ik", &SolveIk<Robot>, "pose"_a, ROBOCELL_IK_ARGS,
            nb::sig("def ik(self, pose: " ROBOCELL_IK_SIG),
            "Joint values that put the TCP at `pose` (in the robot base frame), a Pose, "
            "PyKDL.Frame or 4x4 matrix. The other arguments are those of kinematics.ik.");
  robot.def("ik_solver", &MakeSolver<Robot>, ROBOCELL_IK_SOLVER_ARGS,
            nb::sig(ROBOCELL_IK_SOLVER_SIG), ROBOCELL_IK_SOLVER_DOC);
}

bool MayBePose(nb::handle value) noexcept {
  if (nb::hasattr(value, "M") && nb::hasattr(value, "p")) return true;
  if (!PySequence_Check(value.ptr()) || PyUnicode_Check(value.ptr())) return false;
  const bool has_length = PySequence_Size(value.ptr()) >= 0;  // not so an array without dimensions
  PyErr_Clear();
  return has_length;
}

TwistFrame ToTwistFrame(nb::handle name) {
  const FieldPath path("frame");
  const std::string text = ToText(name, path);
  std::vector<std::string> names;
  for (const auto& [frame, its_name] : kTwistFrames) {
    if (text == its_name) return frame;
    names.emplace_back(its_name);
  }
  ThrowValue(path, "must be one of " + ListNames(names) + ", got '" + text + "'." +
                       DidYouMean(text, names));
}

const char* TwistFrameName(TwistFrame frame) {
  for (const auto& [each, name] : kTwistFrames) {
    if (each == frame) return name;
  }
  return "";
}

void BindKinematics(nb::module_& m) {
  nb::class_<IkResult>(
      m, "IkResult",
      "The answer of inverse kinematics; not finding a solution is a value, no exception.")
      .def_prop_ro(
          "q",
          [](const IkResult& r) {
            return NewRow({r.q.data(), static_cast<size_t>(r.q.size())});
          },
          nb::for_getter(nb::sig("def q(self) -> numpy.typing.NDArray[numpy.float64]")),
          "Joint values in chain order, rad or m; the best met when there is no solution.")
      .def_ro("success", &IkResult::success)
      .def_ro("position_error", &IkResult::position_error, "Metres.")
      .def_ro("rotation_error", &IkResult::rotation_error, "Radians.")
      .def_ro("iterations", &IkResult::iterations,
              "Steps; those that lanes take at once count as one.")
      .def_ro("restarts", &IkResult::restarts, "Starts before the first that led to this solution.")
      .def("__bool__", [](const IkResult& r) { return r.success; })
      .def("__repr__", [](const IkResult& r) {
        return "<IkResult " + std::string(r.success ? "success" : "no solution") + ", " +
               std::to_string(r.position_error) + " m, " + std::to_string(r.rotation_error) +
               " rad>";
      });
  BindIkSolver(m);
  BindChain(m);
  nb::class_<Kinematics> kinematics(
      m, "Kinematics",
      "Kinematics of a robot's arm, from the robot base frame to the TCP.\n\nWhat takes "
      "joint values q (n,) takes many at once, (B, n), and answers with B in front of the shape "
      "(differential_ik, which is for control loops, does not); "
      "arguments with one row are for all. Arrays that are contiguous and of float64 are read "
      "where they are, and the answer is written into `out` when it is given. No result depends "
      "on the batch that it is in. (The Pose that fk returns for one q is computed on its own, and "
      "rounded otherwise than the matrix in a batch or in `out`.)",
      nb::type_slots(kHandleSlots<Kinematics, &VisitKinematics>));
  GuardHandle<Kinematics>(
      kinematics, [](const Kinematics& k, SceneClaims&) { RequireRest(k); },
      [](const Kinematics& k) { k.robot.RequireOpen(); });
  DefDynamics(kinematics);
  kinematics
      .def_prop_ro("joint_names",
                   [](const Kinematics& k) { return SteadyChain(k.robot).joint_names(); })
      .def("ik", &SolveIk<Kinematics>, "target"_a, ROBOCELL_IK_ARGS,
           nb::sig("def ik(self, target: " ROBOCELL_IK_SIG),
           "Joint values that put the TCP at `target` (in the robot base frame): a Pose, a "
           "PyKDL.Frame or a 4x4 matrix. Starts at `seed`, else where the arm is.\n\n"
           "The joints of `locked_groups` stay where the seed has them. "
           "Limits are always obeyed; the same question has the same answer. Damped least squares "
           "(Sugihara 2011) with evenly spread restarts.\n\n"
           "position_weights and rotation_weights (3,): what an error along and about each axis of "
           "the target counts; 0: any value will do. axis (3,): of the rotation only this "
           "direction in the TCP's frame has to point where the target's points, or off by at most "
           "`cone` rad. prefer: 'seed', 'limits' (away from them), 'manipulability' or a posture "
           "(n,) that the solution is to be near to; redundant joints are moved there. Where there "
           "are "
           "none, starts go on beyond max_restarts until 256 in a row have led to no better "
           "solution; "
           "with less than 47 a near one is found in a seventh of the time. filter: a "
           "CollisionFilter, or a function of joint values (k, n) that returns (k,) booleans; "
           "what it does not keep is no solution.")
      .def("ik_solver", &MakeSolver<Kinematics>, ROBOCELL_IK_SOLVER_ARGS,
           nb::sig(ROBOCELL_IK_SOLVER_SIG), ROBOCELL_IK_SOLVER_DOC)
      .def("ik_batch", &SolveBatch, "targets"_a, "seeds"_a = nb::none(),
           "locked_groups"_a = std::vector<std::string>{}, "tolerance"_a = 1e-5, "threads"_a = 1,
           "position_only"_a = false, "max_restarts"_a = 100, "max_iterations"_a = 40,
           nb::kw_only(), "position_weights"_a = nb::none(), "rotation_weights"_a = nb::none(),
           "axis"_a = nb::none(), "cone"_a = 0.0, "prefer"_a = nb::none(), "filter"_a = nb::none(),
           nb::sig("def ik_batch(self, targets: object, seeds: object | None = None, "
                   "locked_groups: collections.abc.Sequence[str] = [], tolerance: float = 1e-05, "
                   "threads: int = 1, position_only: bool = False, max_restarts: int = 100, "
                   "max_iterations: int = 40, *, " ROBOCELL_IK_OBJECTIVES_SIG
                   ") -> types.SimpleNamespace"),
           "Many poses at once, as many at a time as the processor has lanes.\n\n"
           "targets (B, 4, 4) in the robot base frame, or a list of poses; not to be written to by "
           "other threads meanwhile. seeds (B, n) or (n,): "
           "where each search "
           "begins, and where the joints of `locked_groups` stay; without seeds it begins near "
           "the target (what is asked for of the seed, for locked groups and by prefer='seed', is "
           "then "
           "where the robot is). Returns q (B, n), "
           "success (B,), position_error (B,) in m, rotation_error (B,) in rad and iterations "
           "(B,). Limits are always obeyed. An answer does not depend on the batch it is in; "
           "processors with other instruction sets may find another solution. A filter is given "
           "the solutions of many targets at once. The other arguments are those of ik.")
      .def(
          "ik_solutions", &SolveAll, "target"_a, "seed"_a = nb::none(),
          "locked_groups"_a = std::vector<std::string>{}, "tolerance"_a = 1e-5,
          "position_only"_a = false, "starts"_a = 200, "separation"_a = 0.05, nb::kw_only(),
          "position_weights"_a = nb::none(), "rotation_weights"_a = nb::none(),
          "axis"_a = nb::none(), "cone"_a = 0.0, "prefer"_a = nb::none(), "filter"_a = nb::none(),
          nb::sig("def ik_solutions(self, target: Pose | numpy.typing.ArrayLike, seed: object | "
                  "None = None, locked_groups: collections.abc.Sequence[str] = [], tolerance: "
                  "float = 1e-05, position_only: bool = False, starts: int = 200, separation: "
                  "float = 0.05, *, " ROBOCELL_IK_OBJECTIVES_SIG
                  ") -> numpy.typing.NDArray[numpy.float64]"),
          "All solutions (S, n) that `starts` searches find and that are more than `separation` "
          "rad apart in some joint, nearest to the seed first (or best first, by `prefer`).\n\n"
          "Of an arm with redundant joints these are samples of endlessly many; with `prefer` each "
          "is the best of its kind. Of others all are wanted: searches go on until 600 in a row "
          "have found nothing new (not where `starts` is below 48). The other arguments are "
          "those of ik.")
      .def("differential_ik", &SolveTwist, "q"_a, "twist"_a, "frame"_a = "base", "seconds"_a = 0.0,
           "max_speed"_a = nb::none(), "posture"_a = nb::none(), "posture_rate"_a = 1.0,
           "locked_groups"_a = std::vector<std::string>{},
           nb::sig("def differential_ik(self, q: object, twist: numpy.typing.ArrayLike, frame: str "
                   "= 'base', seconds: float = 0.0, max_speed: object | None = None, posture: "
                   "object | None = None, posture_rate: float = 1.0, locked_groups: "
                   "collections.abc.Sequence[str] = []) -> types.SimpleNamespace"),
           "Joint velocities (n,) at q (n,) that move the TCP with `twist` (6,), linear then "
           "angular, m/s and rad/s, in the axes of the robot base frame ('base'), of the TCP "
           "('tip') or "
           "of the 'world'.\n\n"
           "No joint is faster than max_speed (n,) or leaves its limits within `seconds`; among "
           "what is left the twist is met best. Speeds are damped near singularities. Joints to "
           "spare go to `posture` (n,), a share posture_rate of the way per second. Returns "
           "`velocity`, the `twist` that comes of it, and whether it is `slower` than asked.")
      .def(
          "manipulability",
          [](const Kinematics& k, nb::handle q, nb::handle out) {
            return ManipulabilityOf(SteadyChain(k.robot), q, out);
          },
          "q"_a, "out"_a = nb::none(),
          nb::sig("def manipulability(self, q: object, out: numpy.typing.NDArray[numpy.float64] | "
                  "None = None) -> typing.Any"),
          "How well the TCP can move in all directions at q (n,): the root of det(J J^T), "
          "with fewer than six joints of det(J^T J) (Yoshikawa 1985), 0 where a direction is lost; "
          "of a batch (B, n), (B,).")
      .def(
          "reach_map", &MapReachOf, ROBOCELL_REACH_MAP_ARGS,
          nb::sig("def reach_map(self, " ROBOCELL_REACH_MAP_SIG),
          "Where the TCP can be in the box between the corners `lower` and `upper` (3,), m, in the "
          "robot base frame (one layer of cells where they agree along an axis).\n\n"
          "At the centre of each cell so many evenly spread rotations are tried. Returns "
          "`fraction` (X, Y, Z), the share that is solved within the limits; `manipulability` (X, "
          "Y, Z), the mean of the answers'; the centres `x`, `y`, `z`; `cell` and `rotations`. "
          "Collisions are not looked at.\n\nAn arm of less than six joints reaches hardly any "
          "rotation that it is given exactly: of one of five joints ask where an `axis` (3,) of "
          "the TCP points, of a shorter one for the position only, for which `rotations` does not "
          "count.")
      .def(
          "reach_box", [](const Kinematics& k) { return ReachBoxOf(SteadyChain(k.robot)); },
          nb::sig(ROBOCELL_REACH_BOX_SIG),
          "Lower and upper corner (3,), m, of a box in the robot base frame beyond which the TCP "
          "never is: for reach_map. ArgumentError for an arm with a slide without limits.")
      .def_prop_ro(
          "reach", [](const Kinematics& k) { return k.robot.reach(); },
          nb::call_guard<nb::gil_scoped_release>(),
          "Farthest the TCP gets from the root body, metres.");
}

}  // namespace robocell::python
