// Chain: kinematics and dynamics of a serial arm on its own, read from a scene or from PyKDL.
#include "robocell/kinematics/chain.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <cstdint>

#include "arrays.h"
#include "chain_batch.h"
#include "ik_calls.h"
#include "ik_objectives.h"
#include "ik_solver.h"
#include "kinematics.h"
#include "signals.h"
#include "values.h"
#include "robocell/base/error.h"
#include "robocell/kinematics/ik.h"
#include "robocell/kinematics/reach.h"

namespace robocell::python {
namespace {

using namespace nb::literals;

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

nb::object Copy(const RowMajor& matrix) {
  const auto rows = static_cast<size_t>(matrix.rows()), cols = static_cast<size_t>(matrix.cols());
  return NumberCopy({matrix.data(), rows * cols}, {rows, cols});
}

Chain FromScene(const Scene& scene, const std::string& base_body, const std::string& tip_body,
                const std::string& tip_site) {
  if (tip_body.empty() == tip_site.empty())
    throw ArgumentError("chain: give either tip_body or tip_site");
  return Chain(scene.model(), base_body,
               tip_site.empty() ? ChainTip::Body(tip_body) : ChainTip::Site(tip_site));
}

// The model is Python's; a chain copies what it needs of it.
Chain FromModel(nb::handle model, const std::string& base_body, const std::string& tip_body,
                const std::string& tip_site) {
  if (!nb::isinstance(model, nb::module_::import_("mujoco").attr("MjModel"))) {
    throw nb::type_error(("chain: expected a mujoco.MjModel, got " +
                          nb::cast<std::string>(model.type().attr("__name__")))
                             .c_str());
  }
  if (tip_body.empty() == tip_site.empty())
    throw ArgumentError("chain: give either tip_body or tip_site");
  // NOLINTNEXTLINE(performance-no-int-to-ptr): the address is how Python hands the model over.
  const auto* own = reinterpret_cast<const mjModel*>(nb::cast<uintptr_t>(model.attr("_address")));
  return Chain(own, base_body,
               tip_site.empty() ? ChainTip::Body(tip_body) : ChainTip::Site(tip_site));
}

Chain FromKdlChain(nb::handle chain, nb::handle limits) {
  std::vector<std::array<double, 2>> intervals;
  if (!limits.is_none()) {
    const FieldPath path("limits");
    for (const nb::object& item : ToItems(limits, path, "pairs of numbers")) {
      const FieldPath at(path, static_cast<Py_ssize_t>(intervals.size()));
      const Numbers pair(item, at, 2);
      intervals.push_back({pair[0], pair[1]});
    }
  }
  return FromPyKdl(chain, intervals);
}

nb::object Limits(const Chain& chain) {
  RowMajor limits(chain.n_joints(), 2);
  for (int i = 0; i < chain.n_joints(); ++i)
    limits.row(i) << chain.joints()[i].lower, chain.joints()[i].upper;
  return Copy(limits);
}

IkOptions OptionsFor(const Chain& chain, nb::handle seed, double tolerance, bool position_only,
                     const std::vector<std::string>& locked_joints,
                     const IkObjectives& objectives) {
  IkOptions options{.tolerance = tolerance, .position_only = position_only};
  if (seed) options.seed = IkSeed(seed, chain);
  options.locked = LockJoints(chain, locked_joints);
  objectives.Apply(&options);
  return options;
}

IkResult IkOf(const Chain& chain, const PoseOrFrame& target, nb::handle seed, double tolerance,
              bool position_only, int max_restarts, int max_iterations,
              const std::vector<std::string>& locked_joints, nb::handle position_weights,
              nb::handle rotation_weights, nb::handle axis, double cone, nb::handle prefer,
              nb::handle filter) {
  IkOptions options = OptionsFor(chain, seed, tolerance, position_only, locked_joints,
                                 {position_weights, rotation_weights, axis, cone, prefer, filter});
  options.max_restarts = max_restarts;
  options.max_iterations = max_iterations;
  const Pose pose = target.get();
  const nb::gil_scoped_release release;
  SignalPoll poll;
  return Ik(chain, pose, options, [&] { poll(); });
}

IkSolver IkSolverOf(const Chain& chain, double tolerance, bool position_only, int max_restarts,
                    int max_iterations, const std::vector<std::string>& locked_joints,
                    nb::handle position_weights, nb::handle rotation_weights, nb::handle axis,
                    double cone, nb::handle prefer, nb::handle filter) {
  IkOptions options = OptionsFor(chain, {}, tolerance, position_only, locked_joints,
                                 {position_weights, rotation_weights, axis, cone, prefer, filter});
  options.max_restarts = max_restarts;
  options.max_iterations = max_iterations;
  return IkSolver(chain, std::move(options), nb::borrow(filter));
}

nb::object IkBatchOf(const Chain& chain, nb::handle targets, nb::handle seeds, double tolerance,
                     int threads, bool position_only, int max_restarts, int max_iterations,
                     const std::vector<std::string>& locked_joints, nb::handle position_weights,
                     nb::handle rotation_weights, nb::handle axis, double cone, nb::handle prefer,
                     nb::handle filter) {
  IkOptions options = OptionsFor(chain, {}, tolerance, position_only, locked_joints,
                                 {position_weights, rotation_weights, axis, cone, prefer, filter});
  options.max_restarts = max_restarts;
  options.max_iterations = max_iterations;
  return BatchOf(chain, targets, SeedsOf(chain, seeds), options, threads);
}

nb::object IkSolutionsOf(const Chain& chain, const PoseOrFrame& target, nb::handle seed,
                         double tolerance, bool position_only, int starts, double separation,
                         const std::vector<std::string>& locked_joints, nb::handle position_weights,
                         nb::handle rotation_weights, nb::handle axis, double cone,
                         nb::handle prefer, nb::handle filter) {
  IkOptions options = OptionsFor(chain, seed, tolerance, position_only, locked_joints,
                                 {position_weights, rotation_weights, axis, cone, prefer, filter});
  options.max_restarts = RestartsOf(starts);
  return AllSolutionsOf(chain, target.get(), options, separation);
}

nb::object DifferentialIkOf(const Chain& chain, nb::handle q, nb::handle twist, nb::handle frame,
                            double seconds, nb::handle max_speed, nb::handle posture,
                            double posture_rate, const std::vector<std::string>& locked_joints,
                            nb::handle base_in_world) {
  TwistPlace place{.locked = LockJoints(chain, locked_joints)};
  if (!base_in_world.is_none()) {
    place.base_in_world = nb::cast<Pose>(nb::type<Pose>()(base_in_world)).rotation();
  } else if (ToTwistFrame(frame) == TwistFrame::kWorld) {
    throw ArgumentError(
        "frame is 'world', but a chain does not know how its base stands there: give "
        "base_in_world, as robot.base_in_world; or use robot.kinematics");
  }
  return TwistOf(chain, q, twist, frame, seconds, max_speed, posture, posture_rate, place);
}

constexpr const char* kFk =
    "def fk(self, q: object, out: numpy.typing.NDArray[numpy.float64] | None = None) -> typing.Any";
constexpr const char* kJacobian =
    "def jacobian(self, q: object, out: numpy.typing.NDArray[numpy.float64] | None = None, tips: "
    "numpy.typing.NDArray[numpy.float64] | None = None) -> numpy.typing.NDArray[numpy.float64]";
constexpr const char* kMassMatrix =
    "def mass_matrix(self, q: object, out: numpy.typing.NDArray[numpy.float64] | None = None) -> "
    "numpy.typing.NDArray[numpy.float64]";

constexpr const char* kCoriolis =
    "def coriolis_torques(self, q: object, qd: object, out: "
    "numpy.typing.NDArray[numpy.float64] | None = None) -> numpy.typing.NDArray[numpy.float64]";
constexpr const char* kManipulability =
    "def manipulability(self, q: object, out: numpy.typing.NDArray[numpy.float64] | None = None) "
    "-> typing.Any";

void DefDynamics(nb::class_<Chain>& c) {
  c.def("mass_matrix", &MassMatrixOf, "q"_a, "out"_a = nb::none(), nb::sig(kMassMatrix),
        "Returns the joint-space inertia (n, n). It includes armature, also that of fixed tendons.")
      .def("gravity_torques", &GravityTorquesOf, "q"_a,
           "gravity"_a = nb::make_tuple(0.0, 0.0, -9.81), "out"_a = nb::none(),
           nb::sig("def gravity_torques(self, q: object, gravity: numpy.typing.ArrayLike = (0.0, "
                   "0.0, -9.81), out: numpy.typing.NDArray[numpy.float64] | None = None) -> "
                   "numpy.typing.NDArray[numpy.float64]"),
           "Returns the torques (n,) that hold the chain still in `gravity`, (3,) m/s^2 in the "
           "axes of the base. Each body weighs mass * (1 - gravcomp).")
      .def("coriolis_torques", &CoriolisTorquesOf, "q"_a, "qd"_a, "out"_a = nb::none(),
           nb::sig(kCoriolis),
           "Returns the part of the torques (n,) that comes from moving at `qd`.")
      .def("inverse_dynamics", &InverseDynamicsOf, "q"_a, "qd"_a, "qdd"_a,
           "gravity"_a = nb::make_tuple(0.0, 0.0, -9.81), "out"_a = nb::none(),
           nb::sig("def inverse_dynamics(self, q: object, qd: object, qdd: object, gravity: "
                   "numpy.typing.ArrayLike = (0.0, 0.0, -9.81), out: "
                   "numpy.typing.NDArray[numpy.float64] | None = None) -> "
                   "numpy.typing.NDArray[numpy.float64]"),
           "Returns the torques (n,) for a motion. They include gravity and armature, but no "
           "friction, damping or contact.")
      .def_prop_ro("moving_mass", &Chain::moving_mass,
                   "Mass of everything that the chain moves, kg.");
}

#define ROBOCELL_CHAIN_IK_SIG                                             \
  "max_restarts: int = 100, max_iterations: int = 40, *, locked_joints: " \
  "collections.abc.Sequence[str] = [], " ROBOCELL_IK_OBJECTIVES_SIG

void DefIk(nb::class_<Chain>& c) {
  const std::vector<std::string> none;
  c.def("ik", &IkOf, "target"_a, "seed"_a = nb::none(), "tolerance"_a = 1e-5,
        "position_only"_a = false, "max_restarts"_a = 100, "max_iterations"_a = 40, nb::kw_only(),
        "locked_joints"_a = none, "position_weights"_a = nb::none(),
        "rotation_weights"_a = nb::none(), "axis"_a = nb::none(), "cone"_a = 0.0,
        "prefer"_a = nb::none(), "filter"_a = nb::none(),
        nb::sig("def ik(self, target: Pose | numpy.typing.ArrayLike, seed: object | None = None, "
                "tolerance: float = 1e-05, position_only: bool = False, " ROBOCELL_CHAIN_IK_SIG
                ") -> IkResult"),
        "Finds joint values within the limits that put the tip at `target`, a Pose, PyKDL.Frame or "
        "4x4 matrix in the base frame. The search starts at `seed` (n,), by default in the middle "
        "of the limits. `locked_joints`, by name, stay at the seed. The other arguments are those "
        "of Kinematics.ik."
        "\n\nExamples:\n"
        "    >>> chain = robot.chain\n"
        "    >>> target = chain.fk([0.1, 0.4, 0, 1.5, 0, 1.2, 0])\n"
        "    >>> chain.ik(target, seed=robot.jnt_pos_msr).success\n"
        "    True")
      .def("ik_solver", &IkSolverOf, "tolerance"_a = 1e-5, "position_only"_a = false,
           "max_restarts"_a = 100, "max_iterations"_a = 40, nb::kw_only(), "locked_joints"_a = none,
           "position_weights"_a = nb::none(), "rotation_weights"_a = nb::none(),
           "axis"_a = nb::none(), "cone"_a = 0.0, "prefer"_a = nb::none(), "filter"_a = nb::none(),
           nb::sig("def ik_solver(self, tolerance: float = 1e-05, position_only: bool = "
                   "False, " ROBOCELL_CHAIN_IK_SIG ") -> IkSolver"),
           ROBOCELL_IK_SOLVER_DOC)
      .def(
          "ik_batch", &IkBatchOf, "targets"_a, "seeds"_a = nb::none(), "tolerance"_a = 1e-5,
          "threads"_a = 1, "position_only"_a = false, "max_restarts"_a = 100,
          "max_iterations"_a = 40, nb::kw_only(), "locked_joints"_a = none,
          "position_weights"_a = nb::none(), "rotation_weights"_a = nb::none(),
          "axis"_a = nb::none(), "cone"_a = 0.0, "prefer"_a = nb::none(), "filter"_a = nb::none(),
          nb::sig(
              "def ik_batch(self, targets: object, seeds: object | None = None, tolerance: "
              "float = 1e-05, threads: int = 1, position_only: bool = False, " ROBOCELL_CHAIN_IK_SIG
              ") -> types.SimpleNamespace"),
          "Solves many poses, (B, 4, 4) or a list, with seeds (B, n) or (n,). Arguments and result "
          "are those of Kinematics.ik_batch.")
      .def("ik_solutions", &IkSolutionsOf, "target"_a, "seed"_a = nb::none(), "tolerance"_a = 1e-5,
           "position_only"_a = false, "starts"_a = 200, "separation"_a = 0.05, nb::kw_only(),
           "locked_joints"_a = none, "position_weights"_a = nb::none(),
           "rotation_weights"_a = nb::none(), "axis"_a = nb::none(), "cone"_a = 0.0,
           "prefer"_a = nb::none(), "filter"_a = nb::none(),
           nb::sig("def ik_solutions(self, target: Pose | numpy.typing.ArrayLike, seed: object | "
                   "None = None, tolerance: float = 1e-05, position_only: bool = False, starts: "
                   "int = 200, separation: float = 0.05, *, locked_joints: "
                   "collections.abc.Sequence[str] = [], " ROBOCELL_IK_OBJECTIVES_SIG
                   ") -> numpy.typing.NDArray[numpy.float64]"),
           "Returns all distinct solutions (S, n), nearest to the seed first, as "
           "Kinematics.ik_solutions.")
      .def("manipulability", &ManipulabilityOf, "q"_a, "out"_a = nb::none(),
           nb::sig(kManipulability),
           "Returns the root of det(J J^T), with fewer than six joints of det(J^T J), at q (n,) "
           "(Yoshikawa 1985). A batch returns (B,).");
}

void DefMotion(nb::class_<Chain>& c) {
  c.def("differential_ik", &DifferentialIkOf, "q"_a, "twist"_a, "frame"_a = "base",
        "seconds"_a = 0.0, "max_speed"_a = nb::none(), "posture"_a = nb::none(),
        "posture_rate"_a = 1.0, nb::kw_only(), "locked_joints"_a = std::vector<std::string>{},
        "base_in_world"_a = nb::none(),
        nb::sig("def differential_ik(self, q: object, twist: numpy.typing.ArrayLike, frame: str = "
                "'base', seconds: float = 0.0, max_speed: object | None = None, posture: object | "
                "None = None, posture_rate: float = 1.0, *, locked_joints: "
                "collections.abc.Sequence[str] = [], base_in_world: Pose | numpy.typing.ArrayLike "
                "| None = None) -> types.SimpleNamespace"),
        "Computes joint velocities (n,) at q (n,) that move the tip with `twist` (6,), linear then "
        "angular, in the axes of the base ('base'), of the tip ('tip') or of the 'world', where "
        "`base_in_world` is the pose of the base. Joints of `locked_joints`, by name, do not move. "
        "The other arguments are those of Kinematics.differential_ik.")
      .def("reach_map", &ReachMapOf, ROBOCELL_REACH_MAP_ARGS,
           nb::sig("def reach_map(self, " ROBOCELL_REACH_MAP_SIG),
           "Maps where the tip can be in a box of the base frame, as Kinematics.reach_map.")
      .def("reach_box", &ReachBoxOf, nb::sig(ROBOCELL_REACH_BOX_SIG),
           "Returns the lower and upper corner (3,), m, of a box in the base frame that the tip "
           "never leaves. Raises ArgumentError for a chain with a slide without limits.")
      .def_prop_ro("reach", &ApproximateReach, nb::call_guard<nb::gil_scoped_release>(),
                   "The farthest distance of the tip from the origin of the base frame, metres, to "
                   "about 1 %. Computing it takes some milliseconds.");
}

}  // namespace

void BindChain(nb::module_& m) {
  nb::class_<Chain> c(
      m, "Chain",
      "Kinematics and dynamics of a serial arm, from a base to a tip.\n\nA chain is a snapshot of "
      "the simulated model, including everything attached to the arm. All vectors are in the axes "
      "of the base; joint values are in chain order, rad or m. A wrong number of values raises "
      "ArgumentError.\n\nfk, jacobian, manipulability, mass_matrix, gravity_torques, "
      "coriolis_torques and inverse_dynamics also take (B, n) joint values, and return B in front "
      "of the shape. They write into the array `out` if it is given. Arguments with one row apply "
      "to all configurations."
      "\n\nExamples:\n"
      "    >>> chain = robot.chain\n"
      "    >>> chain.n_joints, chain.base_body\n"
      "    (7, 'base_link')");
  c.def_static(
       "from_scene", &FromScene, "scene"_a, "base_body"_a, "tip_body"_a = "", "tip_site"_a = "",
       "Makes a chain of the joints between two bodies, or a body and a site, by their full names.")
      .def_static(
          "from_model", &FromModel, "model"_a, "base_body"_a, "tip_body"_a = "", "tip_site"_a = "",
          nb::sig("def from_model(model: mujoco.MjModel, base_body: str, tip_body: str = '', "
                  "tip_site: str = '') -> Chain"),
          "Makes a chain of a model that MuJoCo's own Python package compiled, as from_scene.")
      .def_static(
          "from_kdl", &FromKdlChain, "chain"_a, "limits"_a = nb::none(),
          nb::sig("def from_kdl(chain: typing.Any, limits: numpy.typing.ArrayLike | None = "
                  "None) -> Chain"),
          "Makes a chain from a PyKDL.Chain. `limits` (n, 2) are the limits of its joints, which a "
          "KDL chain does not contain. Raises ArgumentError for joints with a scale.")
      .def(
          "to_kdl", [](const Chain& chain) { return ToPyKdl(chain); },
          nb::sig("def to_kdl(self) -> typing.Any"),
          "Returns a PyKDL.Chain with its masses. This chain and its robot keep it alive, because "
          "PyKDL's solvers do not keep their chain. Raises ImportError with the install command if "
          "PyKDL is missing.")
      .def_prop_ro("n_joints", &Chain::n_joints, "Number of joints, n.")
      .def_prop_ro("joint_names", &Chain::joint_names, "Names of the joints, in chain order.")
      .def_prop_ro(
          "followers",
          [](const Chain& chain) {
            nb::dict names;
            for (const ChainFollower& follower : chain.followers()) {
              names[nb::cast(follower.joint.name)] =
                  follower.leader < 0 ? nb::none()
                                      : nb::object(nb::cast(chain.joints()[follower.leader].name));
            }
            return names;
          },
          nb::sig("def followers(self) -> dict[str, str | None]"),
          "Joints that follow those of the chain by equality constraints, with the name of their "
          "leader; None for a joint that is held in place. They have no values of their own in q.")
      .def_prop_ro(
          "link_joint_names",
          [](const Chain& chain) {
            std::vector<std::string> names;
            for (const ChainJoint& joint : chain.link_joints()) names.push_back(joint.name);
            return names;
          },
          "Names of the joints and their followers, in the order of the links.")
      .def(
          "expand",
          [](const Chain& chain, nb::handle q) {
            const Numbers values(q, FieldPath("q"));
            return NumberCopy(chain.Expand(values));
          },
          "q"_a, nb::sig("def expand(self, q: object) -> numpy.typing.NDArray[numpy.float64]"),
          "Returns the values of `link_joint_names` for q (n,). PyKDL chains take these.")
      .def_prop_ro("joint_limits", &Limits,
                   "Limits (n, 2), rad or m; infinite for joints without limits.")
      .def_prop_ro("base_body", &Chain::base_body,
                   "Name of the body whose frame is the base frame.")
      .def_prop_ro(
          "tip", [](const Chain& chain) { return chain.tip().name; },
          "Name of the body or site at the end of the chain.")
      .def("fk", &FkOf, "q"_a, "out"_a = nb::none(), nb::sig(kFk),
           "Returns the pose of the tip in the base frame, or matrices (B, 4, 4) for a batch, "
           "which differ by rounding."
           "\n\nExamples:\n"
           "    >>> robot.chain.fk(robot.jnt_pos_msr).translation.shape\n"
           "    (3,)")
      .def("jacobian", &JacobianOf, "q"_a, "out"_a = nb::none(), "tips"_a = nb::none(),
           nb::sig(kJacobian),
           "Returns the Jacobian (6, n) at the tip, linear rows first. If `tips` is given, (4, 4) "
           "or (B, 4, 4), the poses of fk are written into it too, which is faster than two calls."
           "\n\nExamples:\n"
           "    >>> robot.chain.jacobian(np.zeros(7)).shape\n"
           "    (6, 7)");
  DefIk(c);
  DefMotion(c);
  c.def("__repr__", [](const Chain& chain) { return "<" + chain.description() + ">"; });
  DefDynamics(c);
  m.def(
      "jnt_array",
      [](nb::handle values) {
        const FieldPath path("values");
        return ToPyKdl(Numbers(values, path).span());
      },
      "values"_a, nb::sig("def jnt_array(values: object) -> typing.Any"),
      "Converts joint values to a PyKDL.JntArray.");
}

}  // namespace robocell::python
