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
#include "robocell/base/suggestions.h"
#include "robocell/robot/arm_ik.h"

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
                     const std::vector<std::string>& locked_groups, bool position_only,
                     const IkObjectives& objectives) {
  IkOptions options;
  options.position_only = position_only;
  options.seed = IkSeed(seed, robot.chain());
  options.locked = robot.LockGroups(locked_groups);
  objectives.Apply(&options);
  const bool has_weights =
      !objectives.position_weights.is_none() || !objectives.rotation_weights.is_none();
  return has_weights ? options : ForArm(robot, std::move(options));
}

// Without a seed the search starts at the arm's own position.
void StartAtTheArm(const Robot& robot, IkOptions* options) {
  if (options->seed.empty()) options->seed = JointVector(robot.arm().joint_pos());
}

// Returns a copy of the present chain, for work without Python's lock: another thread may reset the
// scene or add objects meanwhile, which replaces the robot's chain.
Chain SteadyChain(const Robot& robot) { return robot.chain(); }

// `Self` is a robot or its kinematics.
template <class Self>
IkResult SolveIk(const Self& self, const PoseOrFrame& target, nb::handle seed,
                 const std::vector<std::string>& locked_groups, double tolerance,
                 bool position_only, int max_restarts, int max_iterations,
                 nb::handle position_weights, nb::handle rotation_weights, nb::handle axis,
                 double cone, nb::handle prefer, nb::handle filter) {
  const Robot& robot = RobotOf(self);
  IkOptions options = OptionsFor(robot, seed, locked_groups, position_only,
                                 {position_weights, rotation_weights, axis, cone, prefer, filter});
  options.tolerance = tolerance;
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
  IkOptions options = OptionsFor(robot, nb::none(), locked_groups, position_only,
                                 {position_weights, rotation_weights, axis, cone, prefer, filter});
  options.tolerance = tolerance;
  options.max_restarts = max_restarts;
  options.max_iterations = max_iterations;
  return IkSolver(SteadyChain(robot), std::move(options), nb::borrow(filter));
}

nb::object SolveAll(const Kinematics& k, const PoseOrFrame& target, nb::handle seed,
                    const std::vector<std::string>& locked_groups, double tolerance,
                    bool position_only, int starts, double separation, nb::handle position_weights,
                    nb::handle rotation_weights, nb::handle axis, double cone, nb::handle prefer,
                    nb::handle filter) {
  IkOptions options = OptionsFor(k.robot, seed, locked_groups, position_only,
                                 {position_weights, rotation_weights, axis, cone, prefer, filter});
  StartAtTheArm(k.robot, &options);
  options.tolerance = tolerance;
  options.max_restarts = RestartsOf(starts);
  return AllSolutionsOf(SteadyChain(k.robot), target.get(), options, separation);
}

nb::object SolveBatch(const Kinematics& k, nb::handle targets, nb::handle seeds,
                      const std::vector<std::string>& locked_groups, double tolerance, int threads,
                      bool position_only, int max_restarts, int max_iterations,
                      nb::handle position_weights, nb::handle rotation_weights, nb::handle axis,
                      double cone, nb::handle prefer, nb::handle filter) {
  IkOptions ik = OptionsFor(k.robot, nb::none(), locked_groups, position_only,
                            {position_weights, rotation_weights, axis, cone, prefer, filter});
  ik.tolerance = tolerance;
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

// Threads may share kinematics while the scene is idle, so calls claim nothing: they read the
// robot's position and work on its chain.
void RequireRest(const Kinematics& k) {
  if (!k.robot.use().by_another_thread()) return;
  throw Error(fmt::format(
      "kinematics of robot '{}': its scene '{}' is in use by another thread, and may be moving it. "
      "In other threads use robot.chain, a copy with the same functions, taken beforehand; or let "
      "the threads take turns with a lock of yours",
      k.robot.name(), k.robot.scene().name()));
}

// By default the world's gravity, in the axes of the robot base frame.
nb::object GravityFor(const Kinematics& k, nb::handle gravity) {
  if (!gravity.is_none()) return nb::borrow(gravity);
  const Eigen::Vector3d g = k.robot.gravity_in_base();
  return nb::make_tuple(g.x(), g.y(), g.z());
}

// The arguments after the target.
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
       "Returns the Pose of the TCP in the robot base frame for joint values q (n,), or matrices "
       "(B, 4, 4) for a batch (B, n).")
      .def(
          "jacobian",
          [](const Kinematics& k, nb::handle q, nb::handle out, nb::handle tips) {
            return JacobianOf(SteadyChain(k.robot), q, out, tips);
          },
          "q"_a, "out"_a = nb::none(), "tips"_a = nb::none(),
          nb::sig("def jacobian(self, q: object, out: numpy.typing.NDArray[numpy.float64] | None = "
                  "None, tips: numpy.typing.NDArray[numpy.float64] | None = None) -> "
                  "numpy.typing.NDArray[numpy.float64]"),
          "Returns the Jacobian (6, n) at the TCP in the axes of the robot base frame, linear rows "
          "first. If `tips` is given, (4, 4) or (B, 4, 4), the poses of fk are written into it "
          "too, which is faster than two calls.")
      .def(
          "gravity_torques",
          [](const Kinematics& k, nb::handle q, nb::handle gravity, nb::handle out) {
            return GravityTorquesOf(SteadyChain(k.robot), q, GravityFor(k, gravity), out);
          },
          "q"_a, "gravity"_a = nb::none(), "out"_a = nb::none(),
          nb::sig("def gravity_torques(self, q: object, gravity: numpy.typing.ArrayLike | None = "
                  "None, out: numpy.typing.NDArray[numpy.float64] | None = None) -> "
                  "numpy.typing.NDArray[numpy.float64]"),
          "Returns the torques (n,) that hold the arm still at q. `gravity`, (3,) m/s^2 in the "
          "axes of the robot base frame, is the scene's by default.")
      .def(
          "mass_matrix",
          [](const Kinematics& k, nb::handle q, nb::handle out) {
            return MassMatrixOf(SteadyChain(k.robot), q, out);
          },
          "q"_a, "out"_a = nb::none(),
          nb::sig("def mass_matrix(self, q: object, out: numpy.typing.NDArray[numpy.float64] | "
                  "None = None) -> numpy.typing.NDArray[numpy.float64]"),
          "Returns the joint-space inertia (n, n). It includes armature, also that of fixed "
          "tendons.")
      .def(
          "coriolis_torques",
          [](const Kinematics& k, nb::handle q, nb::handle qd, nb::handle out) {
            return CoriolisTorquesOf(SteadyChain(k.robot), q, qd, out);
          },
          "q"_a, "qd"_a, "out"_a = nb::none(),
          nb::sig("def coriolis_torques(self, q: object, qd: object, out: "
                  "numpy.typing.NDArray[numpy.float64] | None = None) -> "
                  "numpy.typing.NDArray[numpy.float64]"),
          "Returns the part of the torques (n,) that comes from moving at `qd`.")
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
          "Returns the torques (n,) for a motion. They include gravity and armature, but no "
          "friction, damping or contact.");
}

}  // namespace

void DefRobotIk(nb::class_<Robot>& robot) {
  robot.def("ik", &SolveIk<Robot>, "pose"_a, ROBOCELL_IK_ARGS,
            nb::sig("def ik(self, pose: " ROBOCELL_IK_SIG),
            "Finds joint values that put the TCP at `pose` (in the robot base frame): a Pose, "
            "PyKDL.Frame or 4x4 matrix. The other arguments are those of kinematics.ik."
            "\n\nExamples:\n"
            "    >>> result = robot.ik(robot.fk_frame() * rc.Pose(translation=[0, 0, 0.05]))\n"
            "    >>> result.success\n"
            "    True");
  robot.def("ik_solver", &MakeSolver<Robot>, ROBOCELL_IK_SOLVER_ARGS,
            nb::sig(ROBOCELL_IK_SOLVER_SIG), ROBOCELL_IK_SOLVER_DOC);
}

bool MayBePose(nb::handle value) noexcept {
  if (nb::hasattr(value, "M") && nb::hasattr(value, "p")) return true;
  if (!PySequence_Check(value.ptr()) || PyUnicode_Check(value.ptr())) return false;
  const bool has_length = PySequence_Size(value.ptr()) >= 0;  // not so a 0-d array
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
  nb::class_<IkResult>(m, "IkResult",
                       "The result of inverse kinematics. Finding no solution raises no exception: "
                       "`success` is False.")
      .def_prop_ro(
          "q",
          [](const IkResult& r) {
            return NewRow({r.q.data(), static_cast<size_t>(r.q.size())});
          },
          nb::for_getter(nb::sig("def q(self) -> numpy.typing.NDArray[numpy.float64]")),
          "Joint values in chain order, rad or m. Without a solution, the nearest configuration "
          "found."
          "\n\nExamples:\n"
          "    >>> robot.ik(robot.fk_frame()).q.shape\n"
          "    (7,)")
      .def_ro("success", &IkResult::success,
              "True if the errors are within the tolerances and the joints within their limits."
              "\n\nExamples:\n"
              "    >>> robot.ik(rc.Pose(translation=[9, 0, 0])).success\n"
              "    False")
      .def_ro("position_error", &IkResult::position_error, "Norm of the position error, metres.")
      .def_ro("rotation_error", &IkResult::rotation_error, "Norm of the rotation error, radians.")
      .def_ro("iterations", &IkResult::iterations,
              "Number of steps; steps that vector lanes take together count as one.")
      .def_ro("restarts", &IkResult::restarts,
              "Number of starts before the one that led to this solution.")
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
      "Kinematics of a robot's arm, from the robot base frame to the TCP.\n\nFunctions that take "
      "joint values q (n,) also take batches (B, n), and return B in front of the shape; "
      "differential_ik, which is for control loops, does not. Arguments with one row apply to all "
      "configurations. Contiguous float64 arrays are read in place, and the result is written into "
      "`out` if it is given. No result depends on its batch. (The Pose that fk returns for one q "
      "differs by rounding from the matrix in a batch or in `out`.)",
      nb::type_slots(kHandleSlots<Kinematics, &VisitKinematics>));
  GuardHandle<Kinematics>(
      kinematics, [](const Kinematics& k, SceneClaims&) { RequireRest(k); },
      [](const Kinematics& k) { k.robot.RequireOpen(); });
  DefDynamics(kinematics);
  kinematics
      .def_prop_ro(
          "joint_names", [](const Kinematics& k) { return SteadyChain(k.robot).joint_names(); },
          "Names of the arm's joints, in chain order.")
      .def(
          "ik", &SolveIk<Kinematics>, "target"_a, ROBOCELL_IK_ARGS,
          nb::sig("def ik(self, target: " ROBOCELL_IK_SIG),
          "Finds joint values that put the TCP at `target` (in the robot base frame): a Pose, a "
          "PyKDL.Frame or a 4x4 matrix. The search starts at `seed`, by default at the arm's "
          "joint values.\n\nThe joints of `locked_groups` stay at the seed. Solutions are within "
          "the limits, and the same query returns the same solution. The method is damped least "
          "squares (Sugihara 2011) with evenly spread restarts.\n\nposition_weights, "
          "rotation_weights (3,): weights of the error along and about each axis of the target; 0 "
          "leaves it free. axis (3,): of the rotation, only this direction in the TCP's frame "
          "must agree with the target's, to within `cone` rad. prefer: secondary objective, "
          "'seed', 'limits' (away from them), 'manipulability' or a posture (n,); redundant joints "
          "move accordingly. Without redundant joints, starts continue beyond max_restarts until "
          "256 in a row found nothing better; a max_restarts below 47 returns a near solution in a "
          "seventh of the time. filter: a CollisionFilter, or a function of joint values (k, n) "
          "that returns (k,) booleans; a rejected solution does not count.\n\nExamples:\n"
          "    >>> result = robot.kinematics.ik(robot.fk_frame())\n"
          "    >>> result.position_error < 1e-5\n"
          "    True")
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
           "Solves many poses, as many at a time as the processor has vector lanes.\n\ntargets: "
           "(B, 4, 4) in the robot base frame, or a list of poses; other threads must not write to "
           "it meanwhile. seeds: (B, n) or (n,), where each search starts, and where the joints of "
           "`locked_groups` stay. Without seeds a search starts near the target; locked groups and "
           "prefer='seed' then refer to the robot's present joint values. Returns q (B, n), "
           "success (B,), position_error (B,) in m, rotation_error (B,) in rad and iterations "
           "(B,). Solutions are within the limits and do not depend on the batch; processors with "
           "other instruction sets may find another solution. A filter gets the solutions of many "
           "targets at once. The other arguments are those of ik."
           "\n\nExamples:\n"
           "    >>> target = robot.fk_frame()\n"
           "    >>> robot.kinematics.ik_batch([target, target]).q.shape\n"
           "    (2, 7)")
      .def("ik_solutions", &SolveAll, "target"_a, "seed"_a = nb::none(),
           "locked_groups"_a = std::vector<std::string>{}, "tolerance"_a = 1e-5,
           "position_only"_a = false, "starts"_a = 200, "separation"_a = 0.05, nb::kw_only(),
           "position_weights"_a = nb::none(), "rotation_weights"_a = nb::none(),
           "axis"_a = nb::none(), "cone"_a = 0.0, "prefer"_a = nb::none(), "filter"_a = nb::none(),
           nb::sig("def ik_solutions(self, target: Pose | numpy.typing.ArrayLike, seed: object | "
                   "None = None, locked_groups: collections.abc.Sequence[str] = [], tolerance: "
                   "float = 1e-05, position_only: bool = False, starts: int = 200, separation: "
                   "float = 0.05, *, " ROBOCELL_IK_OBJECTIVES_SIG
                   ") -> numpy.typing.NDArray[numpy.float64]"),
           "Returns all solutions (S, n) that `starts` searches find and that differ by more than "
           "`separation` rad in some joint, nearest to the seed first (or best first, by "
           "`prefer`).\n\nFor an arm with redundant joints these are samples of infinitely many; "
           "with `prefer` each is the best of its kind. For other arms, searches continue until "
           "600 in a row found nothing new (unless `starts` is below 48). The other arguments are "
           "those of ik.")
      .def("differential_ik", &SolveTwist, "q"_a, "twist"_a, "frame"_a = "base", "seconds"_a = 0.0,
           "max_speed"_a = nb::none(), "posture"_a = nb::none(), "posture_rate"_a = 1.0,
           "locked_groups"_a = std::vector<std::string>{},
           nb::sig("def differential_ik(self, q: object, twist: numpy.typing.ArrayLike, frame: str "
                   "= 'base', seconds: float = 0.0, max_speed: object | None = None, posture: "
                   "object | None = None, posture_rate: float = 1.0, locked_groups: "
                   "collections.abc.Sequence[str] = []) -> types.SimpleNamespace"),
           "Computes joint velocities (n,) at q (n,) that move the TCP with `twist` (6,), linear "
           "then angular, m/s and rad/s, in the axes of the robot base frame ('base'), of the TCP "
           "('tip') or of the 'world'.\n\nNo joint exceeds max_speed (n,) or leaves its limits "
           "within `seconds`; within these bounds the twist is matched best. Speeds are damped "
           "near singularities. Redundant joints move towards `posture` (n,), by the share "
           "posture_rate of the distance per second. Returns `velocity`, the resulting `twist`, "
           "and `slower`: whether it is slower than the given one.")
      .def(
          "manipulability",
          [](const Kinematics& k, nb::handle q, nb::handle out) {
            return ManipulabilityOf(SteadyChain(k.robot), q, out);
          },
          "q"_a, "out"_a = nb::none(),
          nb::sig("def manipulability(self, q: object, out: numpy.typing.NDArray[numpy.float64] | "
                  "None = None) -> typing.Any"),
          "Returns how well the TCP can move in all directions at q (n,): the root of det(J J^T), "
          "with fewer than six joints of det(J^T J) (Yoshikawa 1985). It is 0 where a direction is "
          "lost. A batch (B, n) returns (B,).")
      .def("reach_map", &MapReachOf, ROBOCELL_REACH_MAP_ARGS,
           nb::sig("def reach_map(self, " ROBOCELL_REACH_MAP_SIG),
           "Maps where the TCP can be in the box between the corners `lower` and `upper` (3,), m, "
           "in the robot base frame. Where the corners agree along an axis, the map has one layer "
           "of cells.\n\nTries `rotations` evenly spread rotations at the centre of each cell. "
           "Returns `fraction` (X, Y, Z), the share that is solved within the limits; "
           "`manipulability` (X, Y, Z), the mean of the solutions; the centres `x`, `y`, `z`; "
           "`cell` and `rotations`. Collisions are ignored.\n\nAn arm with less than six joints "
           "reaches hardly any exact rotation. With five joints, map where an `axis` (3,) of the "
           "TCP points; with fewer, the position only, for which `rotations` does not count.")
      .def(
          "reach_box", [](const Kinematics& k) { return ReachBoxOf(SteadyChain(k.robot)); },
          nb::sig(ROBOCELL_REACH_BOX_SIG),
          "Returns the lower and upper corner (3,), m, of a box in the robot base frame that the "
          "TCP never leaves, for reach_map. Raises ArgumentError for an arm with a slide without "
          "limits.")
      .def_prop_ro(
          "reach", [](const Kinematics& k) { return k.robot.reach(); },
          nb::call_guard<nb::gil_scoped_release>(),
          "The farthest distance of the TCP from the root body, metres.");
}

}  // namespace robocell::python
