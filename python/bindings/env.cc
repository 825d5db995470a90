// Environments: actions and observations as dictionaries of arrays. Everything for Gymnasium is
// written in Python (robocell.gym).
#include "robocell/env/env.h"

#include <algorithm>
#include <functional>
#include <map>

#include <fmt/format.h>

#include "arrays.h"
#include "bindings.h"
#include "env.h"
#include "features.h"
#include "handles.h"
#include "in_use.h"
#include "number_like.h"
#include "randomized.h"
#include "scene_cycles.h"
#include "scene_sharing.h"
#include "signals.h"
#include "values.h"
#include "robocell/base/suggestions.h"
#include "robocell/data/episode_schema.h"
#include "robocell/env/env_scene.h"
#include "robocell/features/cell_features.h"

namespace robocell::python {

using namespace nb::literals;

std::string Place(const Env& env) { return "environment '" + env.config().name + "'"; }

std::vector<int32_t> BodyIds(std::span<const uint16_t> segments) {
  std::vector<int32_t> ids(segments.begin(), segments.end());
  std::ranges::replace(ids, int32_t{kNoSegment}, -1);
  return ids;
}

int VisitEnv(const Env& env, visitproc visit, void* arg) {
  Py_VISIT(TargetOfTask(env));
  return VisitScene(env.scene(), visit, arg);
}

namespace {

std::vector<std::string> RobotNamesOf(const Env& env) {
  std::vector<std::string> names;
  for (const RobotLayout& robot : env.layout().robots) names.push_back(robot.robot);
  return names;
}

// Reports wrong keys of a dictionary.
void RequireKeys(const Env& env, const FieldPath& path, const nb::dict& values, const char* kind,
                 const std::vector<std::string>& keys, const std::string& why = "") {
  for (const auto& [key, value] : values) {
    const std::string name = ToText(key, path);
    if (std::find(keys.begin(), keys.end(), name) != keys.end()) continue;
    throw ArgumentError(fmt::format("{}: {}: {}{}", Place(env), path.text(),
                                    NoSuchName("", kind, name, keys), why));
  }
  for (const std::string& key : keys) {
    if (values.contains(key.c_str())) continue;
    throw ArgumentError(fmt::format("{}: {} has no '{}'; it takes {}{}", Place(env), path.text(),
                                    key, ListNames(keys), why));
  }
}

nb::dict ToDict(nb::handle value, const FieldPath& path, const char* expected) {
  nb::dict dict;
  if (nb::try_cast(value, dict)) return dict;
  if (!nb::hasattr(value, "keys") || PyDict_Update(dict.ptr(), value.ptr()) != 0) {
    PyErr_Clear();
    ThrowType(path, expected, value);
  }
  return dict;
}

void PutNumbers(nb::handle value, const FieldPath& path, const VectorPart& part,
                std::vector<double>& out) {
  const Numbers numbers(value, path, static_cast<size_t>(part.size));
  std::copy(numbers.span().begin(), numbers.span().end(), out.begin() + part.begin);
}

// Accepts a number, or a list or array of one.
double ToGripper(nb::handle value, const FieldPath& path) {
  const bool many = PySequence_Check(value.ptr()) != 0 && !IsNumber(value);
  return many ? Numbers(value, path, 1)[0] : ToDouble(value, path);
}

// Returns the value of a key in a dictionary; null if it is missing.
nb::object Find(const nb::dict& values, const std::string& key) {
  const auto name = nb::steal(PyUnicode_FromStringAndSize(key.data(), Py_ssize_t(key.size())));
  return nb::borrow(PyDict_GetItem(values.ptr(), name.ptr()));
}

// Returns the robots' parts of an action, which must contain nothing else.
std::vector<nb::object> RobotsOf(const Env& env, const FieldPath& path, const nb::dict& action) {
  const std::vector<RobotLayout>& robots = env.layout().robots;
  std::vector<nb::object> found;
  for (const RobotLayout& robot : robots) found.push_back(Find(action, robot.robot));
  const bool all = std::all_of(found.begin(), found.end(), [](auto& f) { return f.is_valid(); });
  if (!all || action.size() != robots.size())
    RequireKeys(env, path, action, "robot", RobotNamesOf(env));
  return found;
}

void PutCommands(const Env& env, const RobotLayout& robot, const FieldPath& path,
                 const nb::dict& own, std::vector<double>& out) {
  const nb::object command = Find(own, robot.command);
  const nb::object gripper = robot.has_gripper ? Find(own, "gripper") : nb::object();
  const size_t count = robot.has_gripper ? 2 : 1;
  if (!command.is_valid() || gripper.is_valid() != robot.has_gripper || own.size() != count) {
    std::vector<std::string> keys = {robot.command};
    if (robot.has_gripper) keys.emplace_back("gripper");
    RequireKeys(env, path, own, "command", keys,
                fmt::format(" (control_mode {})", ToString(env.config().control_mode)));
  }
  PutNumbers(command, FieldPath(path, robot.command), robot.action, out);
  if (robot.has_gripper) out[robot.gripper_action] = ToGripper(gripper, FieldPath(path, "gripper"));
}

std::vector<double> ToAction(const Env& env, const nb::dict& action) {
  const FieldPath path("action");
  const std::vector<nb::object> robots = RobotsOf(env, path, action);
  std::vector<double> out(static_cast<size_t>(env.layout().action.size()));
  for (size_t i = 0; i < robots.size(); ++i) {
    const RobotLayout& robot = env.layout().robots[i];
    const FieldPath of_robot(path, robot.robot);
    const nb::dict own = ToDict(robots[i], of_robot, "a dict of the robot's commands");
    PutCommands(env, robot, of_robot, own, out);
  }
  return out;
}

// A vector's numbers in a new array, whose parts are slices: an array of its own for each part
// would cost several times as much.
class Sliced {
 public:
  explicit Sliced(std::span<const double> vector) : all_(NumberCopy(vector)) {}
  nb::object operator()(const VectorPart& part) const {
    return nb::object(all_[nb::slice(part.begin, part.begin + part.size, 1)]);
  }
  nb::object operator()(const VectorPart& part, const std::vector<int64_t>& shape) const {
    if (shape.size() == 1) return (*this)(part);
    nb::list sizes;
    for (const int64_t size : shape) sizes.append(size);
    return (*this)(part).attr("reshape")(nb::tuple(sizes));
  }

 private:
  nb::object all_;
};

// Returns the parts of a vector by robot.
nb::dict RobotParts(const std::vector<RobotLayout>& robots, const Sliced& part, bool observation) {
  nb::dict out;
  for (const RobotLayout& robot : robots) {
    nb::dict own;
    if (observation) {
      own["tquat"] = part(robot.tquat);
      own["xyzrpy"] = part(robot.xyzrpy);
      own["joints"] = part(robot.joints);
      if (robot.has_gripper) own["gripper"] = part({robot.gripper, 1});
    } else {
      own[robot.command.c_str()] = part(robot.action);
      if (robot.has_gripper) own["gripper"] = part({robot.gripper_action, 1});
    }
    out[robot.robot.c_str()] = own;
  }
  return out;
}

// Adds the task's parts, objects as {name: {tquat}} and task as {signal: numbers}, and the selected
// features, as {name: numbers}.
void AddTaskParts(const EnvLayout& layout, const Sliced& part, nb::dict& out) {
  if (!layout.features.empty()) {
    nb::dict features;
    for (const FeatureLayout& feature : layout.features)
      features[feature.key.c_str()] = part(feature.part, feature.shape);
    out["features"] = features;
  }
  if (!layout.signals.empty()) {
    nb::dict signals;
    for (const SignalLayout& signal : layout.signals)
      signals[signal.name.c_str()] = part(signal.part, signal.shape);
    out["task"] = signals;
  }
  if (layout.objects.empty()) return;
  nb::dict objects;
  for (const ObjectLayout& object : layout.objects) {
    nb::dict own;
    own["tquat"] = part(object.tquat);
    objects[object.object.c_str()] = own;
  }
  out["objects"] = objects;
}

// Returns {rgb | depth | segmentation: {data, intrinsics, extrinsics}, time}.
nb::dict FrameDict(const CellImage& frame) {
  nb::dict out;
  const auto h = static_cast<size_t>(frame.height), w = static_cast<size_t>(frame.width);
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> intrinsics = frame.camera.intrinsics();
  const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> extrinsics = frame.camera.extrinsics();
  const auto add = [&](const char* kind, nb::object data) {
    nb::dict image;
    image["data"] = data;
    image["intrinsics"] = NumberCopy({intrinsics.data(), 9}, {3, 3});
    image["extrinsics"] = NumberCopy({extrinsics.data(), 16}, {4, 4});
    out[kind] = image;
  };
  if (!frame.rgb.empty()) add("rgb", NewArray<uint8_t>(frame.rgb, {h, w, 3}));
  if (!frame.depth_mm.empty()) add("depth", NewArray<uint16_t>(frame.depth_mm, {h, w, 1}));
  if (!frame.bodies.empty())
    add("segmentation", NewArray<int32_t>(BodyIds(frame.bodies), {h, w, 1}));
  out["time"] = NumberCopy({&frame.time, 1});
  return out;
}

nb::tuple RangeParts(const Env& env, const VectorRange& range, bool observation) {
  const auto dict = [&](const std::vector<double>& ends) {
    const Sliced part(ends);
    nb::dict out = RobotParts(env.layout().robots, part, observation);
    if (observation) AddTaskParts(env.layout(), part, out);
    return out;
  };
  return nb::make_tuple(dict(range.lower), dict(range.upper));
}

// Returns (path, begin, size) of each feature.
nb::tuple PartsOf(const FeatureSchema& schema, const std::vector<std::vector<std::string>>& paths) {
  nb::list out;
  int64_t begin = 0;
  for (size_t i = 0; i < paths.size(); ++i) {
    const int64_t size = schema.features()[i].size();
    nb::list path;
    for (const std::string& key : paths[i]) path.append(key);
    out.append(nb::make_tuple(nb::tuple(path), begin, size));
    begin += size;
  }
  return nb::tuple(out);
}

}  // namespace

nb::tuple ActionParts(const EnvLayout& layout) {
  return PartsOf(layout.commanded, layout.commanded_paths);
}

nb::tuple ObservationParts(const EnvLayout& layout) {
  return PartsOf(layout.observed, layout.observed_paths);
}

nb::dict Observation(const Env& env) {
  const Sliced part(env.observation());
  nb::dict out = RobotParts(env.layout().robots, part, true);
  AddTaskParts(env.layout(), part, out);
  if (env.frames().empty()) return out;
  nb::dict frames;
  for (const CellImage& frame : env.frames()) frames[frame.name.c_str()] = FrameDict(frame);
  out["frames"] = frames;
  return out;
}

namespace {

nb::dict CollisionDict(const Collision& collision) {
  nb::dict out;
  out["robot"] = collision.robot;
  out["body"] = collision.body;
  out["other_robot"] = collision.other_robot;
  out["other_body"] = collision.other_body;
  return out;
}

nb::dict Info(const Env& env, const EnvStep& step) {
  nb::dict out, robots;
  nb::list collisions;
  for (const Collision& collision : step.collisions) collisions.append(CollisionDict(collision));
  for (size_t i = 0; i < env.layout().robots.size(); ++i) {
    const std::string& name = env.layout().robots[i].robot;
    nb::dict robot;
    for (const MotionField& field : kMotionFields)
      robot[field.name] = env.motions()[i].*field.value;
    robot["ik_success"] =
        std::find(step.ik_failed.begin(), step.ik_failed.end(), name) == step.ik_failed.end();
    robot["collision"] =
        std::any_of(step.collisions.begin(), step.collisions.end(),
                    [&](const Collision& c) { return c.robot == name || c.other_robot == name; });
    robots[name.c_str()] = robot;
  }
  out["reason"] = ToString(step.reason);
  out["message"] = step.message;
  out["time"] = step.time;
  out["collisions"] = collisions;
  out["robots"] = robots;
  if (env.config().task) {
    out["is_success"] = step.success;
    out["progress"] = step.progress;
    out["subtask"] = step.subtask;
    out["instruction"] = env.instruction();
  }
  return out;
}

void InitEnv(Env* self, const EnvConfig& config) {
  ImportMujoco();  // before the work starts
  // Another thread may change the configuration while the lock is released.
  const EnvConfig copy = config;  // NOLINT(performance-unnecessary-copy-initialization)
  const nb::gil_scoped_release release;
  new (self) Env(copy, PythonData());
}

nb::tuple ResetEnv(Env& env, std::optional<uint64_t> seed, std::optional<KeyframeChoice> keyframe) {
  const InUse use(env, &Place, "reset");
  {
    const nb::gil_scoped_release release;
    env.Reset({.seed = seed, .keyframe = std::move(keyframe)});
  }
  nb::dict info;
  if (env.config().task) info["instruction"] = env.instruction();
  return nb::make_tuple(Observation(env), info);
}

nb::tuple StepEnv(Env& env, nb::handle action) {
  const nb::dict given = ToDict(action, FieldPath("action"), "a dict of robots");
  const bool by_name = IsByName(given);
  std::vector<double> numbers;
  std::map<std::string, std::vector<double>> commands;
  if (by_name)
    commands = ToNumbersByName(given);
  else
    numbers = ToAction(env, given);
  const InUse use(env, &Place, "stepped");
  EnvStep step;
  {
    const nb::gil_scoped_release release;
    step = by_name ? env.Act(commands, SparsePoll()) : env.Step(numbers, SparsePoll());
  }
  const bool truncated = step.reason == EndReason::kDiverged || step.reason == EndReason::kStopped;
  return nb::make_tuple(Observation(env), step.reward, step.success, truncated, Info(env, step));
}

int TraverseEnv(PyObject* self, visitproc visit, void* arg) {
  Py_VISIT(Py_TYPE(self));
  return nb::inst_ready(self) ? VisitEnv(*nb::inst_ptr<Env>(self), visit, arg) : 0;
}

int ClearEnv(PyObject* self) {
  if (nb::inst_ready(self)) nb::inst_ptr<Env>(self)->DropTask();
  return 0;
}

PyType_Slot env_slots[] = {{Py_tp_traverse, reinterpret_cast<void*>(&TraverseEnv)},
                           {Py_tp_clear, reinterpret_cast<void*>(&ClearEnv)},
                           {0, nullptr}};

}  // namespace

void BindEnv(nb::module_& m) {
  m.def("env_scene_spec", &EnvSceneSpec, "config"_a,
        "Returns the scene of an environment: robots, grippers, objects and cameras in their "
        "frames.\n\nRaises SpecError with all problems of the configuration.");
  nb::class_<Env> env(
      m, "Env",
      "A cell of robots behind reset and step; all poses in the shared base frame.\n\n"
      "Actions are {robot: {'joints' | 'xyzrpy' | 'tquat': numbers, 'gripper': number}},\n"
      "observations {robot: {'tquat': (7,), 'xyzrpy': (6,), 'joints': (n,), 'gripper': (1,)}};\n"
      "with a task {'objects': {id: {'tquat': (7,)}}, 'task': {signal: (n,)}}, with features "
      "{'features': {name: (n,)}}, with streams "
      "{'frames': {stream: {'rgb' |\n"
      "'depth' | 'segmentation': {'data', 'intrinsics', 'extrinsics'}, 'time': (1,)}}};\n"
      "metres, radians, quaternions xyzw, grippers 0 closed ... 1 open. Arrays are copies."
      "\n\nExamples:\n"
      "    >>> observation, info = env.reset(seed=0)\n"
      "    >>> lower, upper = env.action_range\n"
      "    >>> observation, reward, terminated, truncated, info = env.step(lower)",
      nb::type_slots(env_slots), nb::is_weak_referenceable());
  GuardHandle<Env>(
      env,
      [](const Env& e, SceneClaims&) {
        RequireIdle(e, &Place);
        // Long calls claim it for themselves, short ones end before another thread has its turn.
        const SceneUse::Claim free(e.scene().use(), "Env");
      },
      [](const Env& e) {
        if (e.scene().closed()) RequireOpen(e.scene(), Place(e));
      },
      {.always = {"config"}, .closed = {"close"}});
  DefEnvState(env);
  env.def("__init__", &InitEnv, "config"_a)
      .def("reset", &ResetEnv, "seed"_a = nb::none(), "keyframe"_a = nb::none(),
           nb::sig("def reset(self, seed: int | None = None, keyframe: int | str | "
                   "collections.abc.Mapping[str, int | str] | None = None) -> tuple[dict[str, "
                   "typing.Any], dict[str, typing.Any]]"),
           "Resets to a start and returns (observation, info). Without a seed it is the next start "
           "of the last seed. With a keyframe (see Scene.reset) robots start there instead of at "
           "home."
           "\n\nExamples:\n"
           "    >>> observation, info = env.reset(seed=0)\n"
           "    >>> sorted(observation)\n"
           "    ['robot']")
      .def("step", &StepEnv, "action"_a,
           nb::sig("def step(self, action: collections.abc.Mapping[str, typing.Any]) -> "
                   "tuple[dict[str, typing.Any], float, bool, bool, dict[str, typing.Any]]"),
           "Sends the commands, simulates until the step ends, and returns (observation, reward, "
           "terminated, truncated, info).\n\ninfo['reason'] is the reason for its end: arrived, "
           "settled (at rest, but not within arrival_tolerance), collision, ik_failed, timeout, "
           "diverged (then truncated is true, and only reset helps) or stopped (the user closed a "
           "viewer that stops the scene; truncated is true).\n\ninfo['robots'][name] has "
           "ik_success, collision, and the remaining motion:\n\n- joint_error, joint_speed: the "
           "largest of any joint\n- position_error, rotation_error, linear_speed, angular_speed: "
           "of the TCP\n- position_shortfall, rotation_shortfall: from the target to the commanded "
           "pose\n- joint_taken_back, position_taken_back, rotation_taken_back: distance by which "
           "the action's start target was taken back because it led the arm by more than "
           "max_target_lead\n\ninfo['collisions'] lists contacts, by robot and body. With a task "
           "there are info['is_success'], which terminates, 'progress', 'subtask' and "
           "'instruction'.\n\nWrong keys, sizes and numbers that are not finite raise "
           "ArgumentError before anything moves; numbers beyond their range are clipped.\n\nAn "
           "action "
           "may also have the names of action columns in datasets, {'robots/left/action/arm': "
           "numbers}: the targets that the columns describe, without the limits of actions. Groups "
           "without one keep their target.\n\nWhile "
           "another thread steps the environment, every call is an Error. Ctrl-C ends a step "
           "halfway; then only reset helps.\n\nExamples:\n"
           "    >>> observation, info = env.reset(seed=0)\n"
           "    >>> action = {\"robot\": {\"tquat\": [0, 0, -0.02, 0, 0, 0, 1], \"gripper\": 1}}\n"
           "    >>> observation, reward, terminated, truncated, info = env.step(action)\n"
           "    >>> terminated, truncated\n"
           "    (False, False)")
      .def(
          "row",
          [](Env& e) {
            const InUse use(e, &Place, "read");
            CellFeatures& features = e.features();
            {
              const nb::gil_scoped_release release;
              const SceneUse::Claim claim(e.scene().use(), "Env.row");
              features.ReadState();
            }
            nb::dict row = ToArrays(features.observed(), features.state());
            for (const CellImage& frame : e.frames()) PutImage(row, frame);
            return NamedRow(row);
          },
          nb::sig("def row(self) -> dict[str, numpy.typing.NDArray[typing.Any]]"),
          "Returns the present state by the names of columns in datasets: {name: numbers or "
          "image}.\n\nThe images are those of the last observation. With `step`, which takes the "
          "names of action columns too, a policy that was trained on a dataset acts here."
          "\n\nExamples:\n"
          "    >>> observation, info = env.reset(seed=0)\n"
          "    >>> target = env.row()[\"robots/robot/arm/target\"]\n"
          "    >>> step = env.step({\"robots/robot/action/arm\": target + 0.01})")
      .def("save", &Env::Save, "name"_a,
           "Keeps the present state under a name; restore(name) returns to it.")
      .def(
          "restore",
          [](Env& e, const std::string& name) {
            const InUse use(e, &Place, "restored");
            {
              const nb::gil_scoped_release release;
              e.Restore(name);
            }
            return Observation(e);
          },
          "name"_a, nb::sig("def restore(self, name: str) -> dict[str, typing.Any]"),
          "Restores a saved state and returns its observation. All later steps are reproduced "
          "exactly. Raises NotFoundError with the saved states.")
      .def("forget", &Env::Forget, "name"_a, "Drops a saved state.")
      .def_prop_ro(
          "saved", [](const Env& e) { return e.saved(); }, "Returns the names of saved states.")
      .def_prop_ro(
          "randomized", [](const Env& e) { return RandomizedDict(e.randomized()); },
          nb::sig("def randomized(self, /) -> dict[str, float | list[float] | str]"),
          "The values that `randomize` drew for this episode, by their names.")
      .def_prop_ro(
          "instruction", [](const Env& e) { return e.instruction(); },
          "The task's instruction in words; '' without a task.")
      .def("set_origin_to_current", &Env::SetOriginToCurrent, "robot"_a,
           "Makes the last target the origin of later actions (relative_to configured_origin).")
      .def_prop_ro(
          "action_parts", [](const Env& e) { return ActionParts(e.layout()); },
          nb::sig("def action_parts(self, /) -> tuple[tuple[tuple[str, ...], int, int], ...]"),
          "(path in an action's dictionaries, first, number of numbers) of each part of an action "
          "that is written as one vector.")
      .def_prop_ro(
          "observation_parts", [](const Env& e) { return ObservationParts(e.layout()); },
          nb::sig("def observation_parts(self, /) -> tuple[tuple[tuple[str, ...], int, int], ...]"),
          "(path in an observation's dictionaries, first, number of numbers) of each part of an "
          "observation.")
      .def_prop_ro(
          "observed", [](const Env& e) { return FeatureList(e.layout().observed); },
          nb::sig("def observed(self, /) -> list[Feature]"),
          "The parts of observations, with units, frames and ranges; a name is 'observation/' and "
          "the path in the dictionaries.")
      .def_prop_ro(
          "commanded", [](const Env& e) { return FeatureList(e.layout().commanded); },
          nb::sig("def commanded(self, /) -> list[Feature]"),
          "The parts of actions, as in `observed`, such as 'action/left/joints'.")
      .def_prop_ro(
          "action_range", [](const Env& e) { return RangeParts(e, e.layout().action, false); },
          nb::sig("def action_range(self, /) -> tuple[dict[str, typing.Any], "
                  "dict[str, typing.Any]]"),
          "Range of actions: (lower, upper), each like an action."
          "\n\nExamples:\n"
          "    >>> lower, upper = env.action_range")
      .def_prop_ro(
          "observation_range",
          [](const Env& e) { return RangeParts(e, e.layout().observation, true); },
          nb::sig("def observation_range(self, /) -> tuple[dict[str, typing.Any], "
                  "dict[str, typing.Any]]"),
          "Range of observations: (lower, upper), each like an observation.")
      .def_prop_ro(
          "scene", [](const Env& e) { return e.scene(); },
          "The simulation."
          "\n\nExamples:\n"
          "    >>> env.scene.timestep()\n"
          "    0.002")
      .def_prop_ro(
          "config", [](const Env& e) { return EnvConfig(e.config()); },
          "A copy of the environment's configuration.")
      .def(
          "close",
          [](Env& e) {
            const InUse use(e, &Place, "closed");
            const SceneUse::Claim claim(e.scene().use(), "Env.close");
            Scene(e.scene()).Close();
          },
          "Closes the environment and its scene."
          "\n\nExamples:\n"
          "    >>> env.close()");
}

}  // namespace robocell::python
