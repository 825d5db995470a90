// Collision-free motions of robots, and their timing.
#include <nanobind/nanobind.h>

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "handles.h"
#include "kinematics.h"
#include "scene_cycles.h"
#include "signals.h"
#include "values.h"
#include "robocell/motion/motion_planner.h"
#include "robocell/motion/trajectory.h"

namespace nb = nanobind;

namespace robocell::python {

using namespace nb::literals;

namespace {

using Rows = std::vector<std::vector<double>>;
using Pairs = std::vector<std::pair<std::string, std::string>>;

nb::object RowsArray(const Rows& rows, size_t columns) {
  std::vector<double> flat;
  for (const std::vector<double>& row : rows) flat.insert(flat.end(), row.begin(), row.end());
  return NewArray<double>(flat, {rows.size(), columns});
}
nb::object RowsArray(const Rows& rows) {
  return RowsArray(rows, rows.empty() ? 0 : rows[0].size());
}

// Converts (k, n) numbers.
Rows ToRows(nb::handle value, const char* name) {
  std::vector<size_t> shape;
  const std::vector<double> flat = ToDoubles(value, name, shape);
  if (shape.size() != 2)
    throw ArgumentError(fmt::format("{} must be (k, n), got {}", name, ShapeText(shape)));
  Rows rows;
  for (size_t k = 0; k < shape[0]; ++k) {
    const auto first = flat.begin() + static_cast<std::ptrdiff_t>(k * shape[1]);
    rows.emplace_back(first, first + static_cast<std::ptrdiff_t>(shape[1]));
  }
  return rows;
}

// Adds one goal, or all rows of (k, n) joint positions.
void AddGoals(nb::handle value, std::vector<MotionGoal>* goals) {
  if (const MotionGoal* goal = nullptr; nb::try_cast(value, goal) && goal) {
    goals->push_back(*goal);
  } else if (const Pose* pose = nullptr; nb::try_cast(value, pose) && pose) {
    goals->push_back(MotionGoal::Tcp(*pose));
  } else if (std::vector<size_t> shape; true) {
    std::vector<double> flat = ToDoubles(value, "goals", shape);
    if (shape.size() == 1) {
      goals->push_back(MotionGoal::Joints(std::move(flat)));
    } else {
      for (std::vector<double>& q : ToRows(value, "goals"))
        goals->push_back(MotionGoal::Joints(std::move(q)));
    }
  }
}

std::vector<MotionGoal> ToGoals(nb::handle value) {
  std::vector<MotionGoal> goals;
  if (PyList_Check(value.ptr()) || PyTuple_Check(value.ptr())) {
    const std::vector<nb::object> items = ToItems(value, FieldPath("goals"), "a list of goals");
    const bool numbers =
        !items.empty() && PyNumber_Check(items[0].ptr()) && !nb::hasattr(items[0], "__len__");
    if (!numbers) {
      for (const nb::object& item : items) AddGoals(item, &goals);
      return goals;
    }
  }
  AddGoals(value, &goals);
  return goals;
}

MotionResult PlanWith(MotionPlanner& planner, nb::handle goals, nb::handle start,
                      MotionBudget budget) {
  const std::vector<MotionGoal> list = ToGoals(goals);
  std::vector<double> from;
  if (!start.is_none()) from = ToRow(start, "start");
  const nb::gil_scoped_release unlocked;
  SignalPoll poll;
  budget.poll = [&] { poll(); };
  return start.is_none() ? planner.Plan(list, budget) : planner.PlanFrom(from, list, budget);
}

MotionOptions OptionsOf(std::vector<std::string> groups, double clearance, Pairs allowed,
                        Pairs attached, const AxisConstraint* keep_axis) {
  MotionOptions options{.groups = std::move(groups),
                        .clearance = clearance,
                        .allowed_contacts = std::move(allowed),
                        .attached = std::move(attached)};
  if (keep_axis) options.keep_axis = *keep_axis;
  return options;
}

MotionBudget BudgetOf(uint64_t seed, int iterations, std::optional<double> deadline, int shortcuts,
                      int most_goals) {
  return {.seed = seed,
          .iterations = iterations,
          .deadline = deadline,
          .shortcuts = shortcuts,
          .most_goals = most_goals};
}

// Converts one value for each planned joint.
std::vector<double> ToPlanned(const MotionPlanner& planner, nb::handle q) {
  std::vector<double> values = ToRow(q, "q");
  const size_t n = planner.joint_names().size();
  if (values.size() != n)
    throw ArgumentError(fmt::format("q must be ({},), got ({},)", n, values.size()));
  return values;
}

int VisitPlanner(const MotionPlanner& planner, visitproc visit, void* arg) {
  return VisitScene(planner.robot().scene(), visit, arg);
}

Eigen::Vector3d ToDirection(nb::handle value, const char* name) {
  const Numbers three(value, FieldPath(name), 3);
  return {three[0], three[1], three[2]};
}

std::array<double, 3> ToThree(nb::handle value, const char* name) {
  const Numbers three(value, FieldPath(name), 3);
  return {three[0], three[1], three[2]};
}

nb::object ThreeArray(const std::array<double, 3>& values) { return NewRow(values); }

void BindGoal(nb::module_& m) {
  nb::class_<MotionGoal>(
      m, "MotionGoal",
      "A goal of a motion: a pose of the TCP in the world with as much freedom as the task leaves, "
      "or joint positions."
      "\n\nExamples:\n"
      "    >>> grasp = rc.motion.MotionGoal(robot.tcp_in_world, free_rotation=(0, 0, 3.15))\n"
      "    >>> goal = rc.motion.MotionGoal.at_joints(robot.jnt_pos_msr)")
      .def(
          "__init__",
          [](MotionGoal* self, const Pose& tcp, nb::handle box, nb::handle rotation,
             const std::string& arm) {
            new (self) MotionGoal{.tcp = tcp,
                                  .position_box = ToThree(box, "position_box"),
                                  .free_rotation = ToThree(rotation, "free_rotation"),
                                  .arm = arm};
          },
          "tcp"_a, "position_box"_a = nb::make_tuple(0, 0, 0),
          "free_rotation"_a = nb::make_tuple(0, 0, 0), "arm"_a = "",
          nb::sig("def __init__(self, tcp: Pose, position_box: numpy.typing.ArrayLike = (0, 0, 0), "
                  "free_rotation: numpy.typing.ArrayLike = (0, 0, 0), arm: str = '') -> None"),
          "tcp: pose of the TCP in the world. position_box: largest displacement along each axis "
          "of "
          "`tcp`, m, to both sides. free_rotation: largest rotation about each, rad; pi for any. "
          "arm: the group, by default the first planned one.")
      .def_static(
          "at_joints", [](nb::handle q) { return MotionGoal::Joints(ToRow(q, "q")); }, "q"_a,
          nb::sig("def at_joints(q: numpy.typing.ArrayLike) -> MotionGoal"),
          "Returns the goal of joint positions (n,), one for each planned joint, rad or m.")
      .def_prop_ro(
          "joints", [](const MotionGoal& g) { return NewArray(g.joints); },
          nb::for_getter(nb::sig("def joints(self) -> numpy.typing.NDArray[numpy.float64]")),
          "Joint positions (n,); empty for a pose.")
      .def_ro("tcp", &MotionGoal::tcp, "Pose of the TCP in the world.")
      .def_prop_ro(
          "position_box", [](const MotionGoal& g) { return ThreeArray(g.position_box); },
          nb::for_getter(nb::sig("def position_box(self) -> numpy.typing.NDArray[numpy.float64]")),
          "Largest displacement along each axis (3,), m.")
      .def_prop_ro(
          "free_rotation", [](const MotionGoal& g) { return ThreeArray(g.free_rotation); },
          nb::for_getter(nb::sig("def free_rotation(self) -> numpy.typing.NDArray[numpy.float64]")),
          "Largest rotation about each axis (3,), rad.")
      .def_ro("arm", &MotionGoal::arm, "The arm group; \"\" for the first planned one.");
  nb::class_<AxisConstraint>(
      m, "AxisConstraint",
      "Keeps a direction of the TCP near one of the world during a motion, such as that of a cup."
      "\n\nExamples:\n"
      "    >>> upright = rc.motion.AxisConstraint([0, 0, 1], tolerance=0.15)")
      .def(
          "__init__",
          [](AxisConstraint* self, nb::handle tcp, nb::handle world, double tolerance,
             const std::string& arm) {
            new (self) AxisConstraint{.axis_in_tcp = ToDirection(tcp, "axis_in_tcp"),
                                      .axis_in_world = ToDirection(world, "axis_in_world"),
                                      .tolerance = tolerance,
                                      .arm = arm};
          },
          "axis_in_tcp"_a, "axis_in_world"_a = nb::make_tuple(0, 0, 1), "tolerance"_a = 0.1,
          "arm"_a = "",
          nb::sig("def __init__(self, axis_in_tcp: numpy.typing.ArrayLike, axis_in_world: "
                  "numpy.typing.ArrayLike = (0, 0, 1), tolerance: float = 0.1, arm: str = '') -> "
                  "None"),
          "axis_in_tcp: direction in the TCP frame. axis_in_world: direction that it keeps. "
          "tolerance: largest angle between them, rad. arm: the group, by default the first "
          "planned "
          "one.")
      .def_ro("tolerance", &AxisConstraint::tolerance, "Largest angle, rad.")
      .def_ro("arm", &AxisConstraint::arm, "The arm group; \"\" for the first planned one.");
}

void BindResult(nb::module_& m) {
  nb::class_<MotionResult>(
      m, "MotionResult",
      "The result of planning a motion. Finding none raises no exception: `success` is False."
      "\n\nExamples:\n"
      "    >>> result = robot.plan(robot.jnt_pos_msr + 0.1)\n"
      "    >>> result.success, result.failure, result.path.shape\n"
      "    (True, 'none', (2, 7))")
      .def_ro("success", &MotionResult::success, "True if there is a path.")
      .def_prop_ro(
          "failure", [](const MotionResult& r) { return ToString(r.failure); },
          "\"none\", \"start_in_collision\", \"start_beyond_limits\", "
          "\"start_against_constraint\", \"goal_unreachable\", \"goal_in_collision\", "
          "\"goal_against_constraint\" or \"no_path\".")
      .def_ro("message", &MotionResult::message,
              "What is wrong, where, and what to try; \"\" without a failure.")
      .def_ro("more_may_help", &MotionResult::more_may_help,
              "True if more iterations may find a path after \"no_path\".")
      .def_prop_ro(
          "path", [](const MotionResult& r) { return RowsArray(r.path); },
          nb::for_getter(nb::sig("def path(self) -> numpy.typing.NDArray[numpy.float64]")),
          "Way points (k, n) from the start to the goal, straight in between; rad or m.")
      .def_ro("goal", &MotionResult::goal, "Index of the reached goal; -1 without a path.")
      .def_ro("iterations", &MotionResult::iterations, "How often the trees grew.")
      .def_ro("configurations", &MotionResult::configurations,
              "Number of configurations checked by spheres.")
      .def_ro("distances", &MotionResult::distances, "Number of distances computed by the engine.")
      .def("__bool__", [](const MotionResult& r) { return r.success; })
      .def("__repr__", [](const MotionResult& r) {
        return r.success ? fmt::format("<MotionResult: {} waypoints>", r.path.size())
                         : fmt::format("<MotionResult: {}>", ToString(r.failure));
      });
}

#define PLANNER_SIGNATURE                                                                        \
  "groups: list[str] = [], clearance: float = 0.001, allowed_contacts: list[tuple[str, str]] = " \
  "[], attached: list[tuple[str, str]] = [], keep_axis: AxisConstraint | None = None"
#define BUDGET_SIGNATURE                                                                     \
  "seed: int = 0, iterations: int = 10000, deadline: float | None = None, shortcuts: int = " \
  "40, most_goals: int = 32"
#define GOALS_SIGNATURE                                                               \
  "goals: MotionGoal | Pose | numpy.typing.ArrayLike | Sequence[MotionGoal | Pose | " \
  "numpy.typing.ArrayLike]"

void BindPlanner(nb::module_& m) {
  nb::class_<MotionPlanner> planner(
      m, "MotionPlanner",
      "Plans collision-free motions of a robot, many from one planner."
      "\n\nExamples:\n"
      "    >>> planner = rc.motion.MotionPlanner(robot, clearance=0.005)\n"
      "    >>> planner.plan([robot.jnt_pos_msr + 0.1, robot.jnt_pos_msr - 0.2]).goal\n"
      "    0",
      nb::type_slots(kHandleSlots<MotionPlanner, &VisitPlanner>));
  GuardHandle<MotionPlanner>(
      planner, [](const MotionPlanner& p, SceneClaims& claims) { claims.Add(p.robot().use()); },
      [](const MotionPlanner& p) { p.robot().RequireOpen(); }, {.always = {"joint_names"}});
  planner
      .def(
          "__init__",
          [](MotionPlanner* self, const Robot& robot, std::vector<std::string> groups,
             double clearance, Pairs allowed, Pairs attached, const AxisConstraint* keep_axis) {
            const MotionOptions options = OptionsOf(
                std::move(groups), clearance, std::move(allowed), std::move(attached), keep_axis);
            const nb::gil_scoped_release unlocked;
            new (self) MotionPlanner(robot, options);
          },
          "robot"_a, nb::kw_only(), "groups"_a = std::vector<std::string>{}, "clearance"_a = 0.001,
          "allowed_contacts"_a = Pairs{}, "attached"_a = Pairs{}, "keep_axis"_a = nb::none(),
          nb::sig("def __init__(self, robot: Robot, *, " PLANNER_SIGNATURE ") -> None"),
          "groups: groups whose joints move, by default the first arm; several arms, or a planar "
          "base with its arm, move at once. clearance: least distance to everything that is not "
          "the "
          "robot, m. allowed_contacts: pairs of bodies that may touch, with their subtrees; \"\" "
          "stands for everything. attached: bodies that move with another body, (\"cube\", "
          "\"hand\"). keep_axis: a constraint on the whole motion.")
      .def(
          "plan",
          [](MotionPlanner& p, nb::handle goals, nb::handle start, uint64_t seed, int iterations,
             std::optional<double> deadline, int shortcuts, int most_goals) {
            return PlanWith(p, goals, start,
                            BudgetOf(seed, iterations, deadline, shortcuts, most_goals));
          },
          "goals"_a, nb::kw_only(), "start"_a = nb::none(), "seed"_a = 0, "iterations"_a = 10000,
          "deadline"_a = nb::none(), "shortcuts"_a = 40, "most_goals"_a = 32,
          nb::sig("def plan(self, " GOALS_SIGNATURE
                  ", *, start: numpy.typing.ArrayLike | None = None, " BUDGET_SIGNATURE
                  ") -> MotionResult"),
          "Plans a motion to any one of the goals: MotionGoals, poses of the TCP in the world, "
          "joint "
          "positions (n,) or (k, n), or a list of these. Without `start` it looks at the scene's "
          "present state first, and starts there; with it the surroundings are those of the last "
          "update. `deadline` in seconds ends the search, and makes results depend on the "
          "processor.")
      .def(
          "plan_line",
          [](MotionPlanner& p, const Pose& tcp, nb::handle start, const std::string& arm) {
            std::vector<double> from;
            if (!start.is_none()) from = ToRow(start, "start");
            const nb::gil_scoped_release unlocked;
            if (from.empty()) {
              p.Update();
              from = p.present();
            }
            return p.PlanLine(from, tcp, arm);
          },
          "tcp"_a, nb::kw_only(), "start"_a = nb::none(), "arm"_a = "",
          nb::sig("def plan_line(self, tcp: Pose, *, start: numpy.typing.ArrayLike | None = None, "
                  "arm: str = '') -> MotionResult"),
          "Moves the TCP on a straight line to a pose in the world. Without success `path` is the "
          "part before the problem.")
      .def("update", &MotionPlanner::Update, nb::call_guard<nb::gil_scoped_release>(),
           "Copies the scene's present state.")
      .def(
          "is_free", [](const MotionPlanner& p, nb::handle q) { return p.IsFree(ToPlanned(p, q)); },
          "q"_a, nb::sig("def is_free(self, q: numpy.typing.ArrayLike) -> bool"),
          "Returns True if joint positions (n,) keep the clearance, by the engine's distances.")
      .def(
          "clearance",
          [](const MotionPlanner& p, nb::handle q, double horizon) {
            return p.Clearance(ToPlanned(p, q), horizon);
          },
          "q"_a, "horizon"_a = 0.1,
          nb::sig("def clearance(self, q: numpy.typing.ArrayLike, horizon: float = 0.1) -> float"),
          "Returns the smallest distance of what moves to everything else and to itself, m; at "
          "most "
          "`horizon`.")
      .def_prop_ro("joint_names", &MotionPlanner::joint_names,
                   "Names of the planned joints, in the order of all configurations.")
      .def_prop_ro(
          "joint_limits",
          [](const MotionPlanner& p) {
            std::vector<double> flat;
            for (const Interval& i : p.joint_limits()) flat.insert(flat.end(), {i.lower, i.upper});
            return NewArray<double>(flat, {flat.size() / 2, 2});
          },
          nb::for_getter(nb::sig("def joint_limits(self) -> numpy.typing.NDArray[numpy.float64]")),
          "Limits of the planned joints (n, 2); infinite without.");

  nb::borrow<nb::class_<Robot>>(nb::type<Robot>())
      .def(
          "plan",
          [](const Robot& r, nb::handle goals, std::vector<std::string> groups, double clearance,
             Pairs allowed, Pairs attached, const AxisConstraint* keep_axis, uint64_t seed,
             int iterations, std::optional<double> deadline, int shortcuts, int most_goals) {
            MotionPlanner planner(r, OptionsOf(std::move(groups), clearance, std::move(allowed),
                                               std::move(attached), keep_axis));
            return PlanWith(planner, goals, nb::none(),
                            BudgetOf(seed, iterations, deadline, shortcuts, most_goals));
          },
          "goals"_a, nb::kw_only(), "groups"_a = std::vector<std::string>{}, "clearance"_a = 0.001,
          "allowed_contacts"_a = Pairs{}, "attached"_a = Pairs{}, "keep_axis"_a = nb::none(),
          "seed"_a = 0, "iterations"_a = 10000, "deadline"_a = nb::none(), "shortcuts"_a = 40,
          "most_goals"_a = 32,
          nb::sig("def plan(self, " GOALS_SIGNATURE ", *, " PLANNER_SIGNATURE ", " BUDGET_SIGNATURE
                  ") -> MotionResult"),
          "Plans a collision-free motion from the present joint positions to any one of the goals: "
          "poses of the TCP in the world, joint positions, robocell.motion.MotionGoal, or a list "
          "of "
          "these. The arguments are those of robocell.motion.MotionPlanner and its `plan`; a "
          "planner "
          "that is kept saves some milliseconds each time."
          "\n\nExamples:\n"
          "    >>> robot.plan(robot.tcp_in_world).success\n"
          "    True");
}

MotionLimits ToLimits(nb::handle velocity, nb::handle acceleration, nb::handle jerk) {
  const auto limits = [](nb::handle value, const char* name) {
    return PyFloat_Check(value.ptr()) || PyLong_Check(value.ptr())
               ? std::vector{ToDouble(value, FieldPath(name))}
               : ToRow(value, name);
  };
  return {.velocity = limits(velocity, "velocity"),
          .acceleration = limits(acceleration, "acceleration"),
          .jerk = limits(jerk, "jerk")};
}

#define LIMITS_SIGNATURE                                                   \
  "velocity: float | numpy.typing.ArrayLike = 1.0, acceleration: float | " \
  "numpy.typing.ArrayLike = 3.0, jerk: float | numpy.typing.ArrayLike = 20.0"

void BindTrajectory(nb::module_& m) {
  nb::class_<Trajectory>(m, "Trajectory",
                         "A path over time; straight lines from waypoint to waypoint, at rest in "
                         "each of them.")
      .def_prop_ro("duration", &Trajectory::duration, "Seconds.")
      .def_prop_ro("n_joints", &Trajectory::n_joints, "Number of joints.")
      .def(
          "at",
          [](const Trajectory& t, double time) {
            const TrajectoryPoint point = t.At(time);
            return nb::make_tuple(NewArray(point.position), NewArray(point.velocity),
                                  NewArray(point.acceleration));
          },
          "time"_a,
          nb::sig("def at(self, time: float) -> tuple[numpy.typing.NDArray[numpy.float64], "
                  "numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64]]"),
          "Returns positions, velocities and accelerations (n,) at a time in seconds.")
      .def(
          "sample",
          [](const Trajectory& t, double tick) { return RowsArray(t.Sample(tick), t.n_joints()); },
          "tick"_a, nb::sig("def sample(self, tick: float) -> numpy.typing.NDArray[numpy.float64]"),
          "Returns the positions (k, n) at 0, tick, 2 tick, ..., and at the end.");
  m.def(
      "time_path",
      [](nb::handle path, nb::handle velocity, nb::handle acceleration, nb::handle jerk) {
        return TimePath(ToRows(path, "path"), ToLimits(velocity, acceleration, jerk));
      },
      "path"_a, nb::kw_only(), "velocity"_a = 1.0, "acceleration"_a = 3.0, "jerk"_a = 20.0,
      nb::sig("def time_path(path: numpy.typing.ArrayLike, *, " LIMITS_SIGNATURE ") -> Trajectory"),
      "Times a path (k, n) within limits of velocity, acceleration and jerk, one for each joint or "
      "one for all: rad or m, and seconds. Raises ArgumentError for limits that are not above 0."
      "\n\nExamples:\n"
      "    >>> motion = rc.motion.time_path([[0.0, 0.0], [1.0, 0.5]], velocity=1.5)\n"
      "    >>> motion.sample(0.01).shape[1]\n"
      "    2");
  m.def(
      "why_too_slow",
      [](nb::handle path, double seconds, const std::vector<std::string>& joint_names,
         nb::handle velocity, nb::handle acceleration, nb::handle jerk) {
        return WhyTooSlow(ToRows(path, "path"), ToLimits(velocity, acceleration, jerk), seconds,
                          joint_names);
      },
      "path"_a, "seconds"_a, "joint_names"_a = std::vector<std::string>{}, nb::kw_only(),
      "velocity"_a = 1.0, "acceleration"_a = 3.0, "jerk"_a = 20.0,
      nb::sig("def why_too_slow(path: numpy.typing.ArrayLike, seconds: float, joint_names: "
              "list[str] = [], *, " LIMITS_SIGNATURE ") -> str"),
      "Returns why a path (k, n) takes longer than `seconds` within the limits, naming the joint "
      "whose limits count most; \"\" if it does not."
      "\n\nExamples:\n"
      "    >>> rc.motion.why_too_slow([[0.0], [1.0]], 10.0)\n"
      "    ''");
}

}  // namespace

void BindMotion(nb::module_& m) {
  BindGoal(m);
  BindResult(m);
  BindPlanner(m);
  BindTrajectory(m);
}

}  // namespace robocell::python
