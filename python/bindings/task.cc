// Tasks and experts, and subclassing them in Python. C++ threads may call them: each call takes the
// GIL. pick.cc has those of the pick task.
#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/tuple.h>

#include <algorithm>
#include <tuple>

#include "bindings.h"
#include "body_poses.h"
#include "features.h"
#include "number_like.h"
#include "rng.h"
#include "spec_fields.h"
#include "task_trampolines.h"
#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/scenes/catalogue.h"

namespace nb = nanobind;

namespace robocell::python {

Map<ObjectPlace> ToPlaces(nb::handle made) {
  Map<ObjectPlace> places;
  Convert<Map<ObjectPlace>>::Set(places, made, FieldPath("places"));
  return places;
}

using namespace nb::literals;

Rng& PythonRng::get() {
  if (own_) return *own_;
  if (!*lent_) {
    throw Error(
        "this Rng was lent for one call, which is over; keep rng.fork('a purpose') instead");
  }
  return **lent_;
}

TaskVerdict ToVerdict(nb::handle self, nb::handle made) {
  if (nb::isinstance<TaskVerdict>(made)) return nb::cast<TaskVerdict>(made);
  ThrowReturned(self, "judge", "a TaskVerdict", made);
}

namespace {

// Converts {name: (lower, upper)}, privileged; a Feature instead of a pair sets everything itself.
// Two numbers are the bounds of one number, two lists those of a row of numbers.
Feature ToSignal(const std::string& name, nb::handle value, const FieldPath& path) {
  if (nb::isinstance<Feature>(value)) {
    Feature feature = nb::cast<Feature>(value);
    feature.column.name = name;
    return feature;
  }
  constexpr const char* kExpected = "a pair (lower, upper) or a Feature";
  const std::vector<nb::object> pair = ToItems(value, path, kExpected);
  if (pair.size() != 2) ThrowType(path, kExpected, value);
  constexpr FeatureRole role = FeatureRole::kPrivileged;
  if (IsNumber(pair[0]) && IsNumber(pair[1])) {
    return {.column = {.name = name},
            .role = role,
            .lower = {ToDouble(pair[0], path)},
            .upper = {ToDouble(pair[1], path)}};
  }
  const Numbers lower(pair[0], path), upper(pair[1], path);
  if (lower.size() != upper.size() || lower.size() == 0) {
    ThrowValue(path, "needs a range: as many lower as upper bounds, and none above the other");
  }
  return {.column = {.name = name, .shape = {static_cast<int64_t>(lower.size())}},
          .role = role,
          .lower = {lower.span().begin(), lower.span().end()},
          .upper = {upper.span().begin(), upper.span().end()}};
}

[[noreturn]] void ThrowUnknownSignal(const FieldPath& path, const nb::dict& values,
                                     const std::vector<Feature>& signals) {
  std::vector<std::string> names;
  for (const Feature& signal : signals) names.push_back(signal.column.name);
  for (const auto& [key, value] : values) {
    const std::string name = ToText(key, path);
    if (std::find(names.begin(), names.end(), name) == names.end())
      ThrowValue(path,
                 fmt::format("returns '{}', which signals() does not name; it names {}.{}", name,
                             names.empty() ? "none" : ListNames(names), DidYouMean(name, names)));
  }
  ThrowValue(path, "returns more values than signals() names");
}

}  // namespace

std::vector<Feature> ToSignals(nb::handle self, nb::handle made) {
  return ConvertReturned(self, "signals", [&] {
    const std::string text = MethodText(self, "signals");
    const FieldPath path(text);
    std::vector<Feature> signals;
    if (nb::isinstance<nb::dict>(made)) {
      for (const auto& [key, value] : nb::borrow<nb::dict>(made)) {
        const std::string name = ToText(key, path);
        signals.push_back(ToSignal(name, value, FieldPath(path, name)));
      }
      return signals;
    }
    constexpr const char* kExpected = "a dict of names to (lower, upper), or a list of Feature";
    for (const nb::object& item : ToItems(made, path, kExpected)) {
      if (!nb::isinstance<Feature>(item)) ThrowType(path, kExpected, made);
      signals.push_back(nb::cast<Feature>(item));
    }
    return signals;
  });
}

void PutSignals(nb::handle self, nb::handle made, const std::vector<Feature>& signals,
                std::span<double> out) {
  ConvertReturned(self, "observe", [&] {
    const std::string text = MethodText(self, "observe");
    const FieldPath path(text);
    nb::dict values;
    if (!nb::try_cast(made, values)) ThrowType(path, "a dict of signals", made);
    for (const Feature& signal : signals) {
      const std::string& name = signal.column.name;
      if (!values.contains(name.c_str()))
        ThrowValue(path, fmt::format("has no '{}', which signals() names", name));
      const auto size = static_cast<size_t>(signal.size());
      PutValues(values[name.c_str()], signal.column.shape, FieldPath(path, name), out.first(size));
      out = out.subspan(size);
    }
    if (values.size() > signals.size()) ThrowUnknownSignal(path, values, signals);
  });
}

std::vector<double> ToMemory(nb::handle self, nb::handle made) {
  return ConvertReturned(self, "memory", [&] {
    const std::string text = MethodText(self, "memory");
    const Numbers numbers(made, FieldPath(text));
    return std::vector<double>(numbers.span().begin(), numbers.span().end());
  });
}

BodyPoses ToStarts(nb::handle self, nb::handle made) {
  return ConvertReturned(self, "starts", [&] {
    const std::string text = MethodText(self, "starts");
    return ToBodyPoses(made, FieldPath(text));
  });
}

nb::object MemoryArray(std::span<const double> memory) { return NumberCopy(memory); }

namespace {

nb::object TaskMemory(const char* function) {
  return nb::module_::import_("robocell._task_memory").attr(function);
}

}  // namespace

// Attributes of a user's task have methods of their own, such as __deepcopy__.

void RememberBound(nb::handle self) {
  CallPython(self, "bind", [&] { TaskMemory("remember_bound")(self); });
}

void AddMemoryOfAttributes(nb::handle self, std::vector<double>& memory) {
  const nb::object made =
      CallPython(self, "memory", [&] { return nb::object(TaskMemory("memory_of")(self)); });
  const Numbers numbers(made, FieldPath("memory"));
  memory.insert(memory.end(), numbers.span().begin(), numbers.span().end());
}

void RecallAttributes(nb::handle self, std::span<const double> memory) {
  const nb::gil_scoped_acquire acquire;
  CallPython(self, "recall", [&] { TaskMemory("recall")(self, MemoryArray(memory)); });
}

bool HasAttributes(std::span<const double> memory) {
  const nb::gil_scoped_acquire acquire;
  return nb::cast<bool>(TaskMemory("has_attributes")(MemoryArray(memory)));
}

namespace {

void BindTaskParts(nb::module_& m) {
  nb::class_<TaskVerdict>(m, "TaskVerdict",
                          "A task's judgement of a state."
                          "\n\nExamples:\n"
                          "    >>> rc.tasks.TaskVerdict(reward=0.5, success=False)\n"
                          "    TaskVerdict(reward=0.5, success=False, progress=0, subtask=0)")
      .def(
          "__init__",
          [](TaskVerdict* self, double reward, nb::handle success, double progress, int subtask) {
            // Comparing NumPy's numbers gives a NumPy bool.
            new (self)
                TaskVerdict{reward, ToBool(success, FieldPath("success")), progress, subtask};
          },
          "reward"_a = 0.0, "success"_a = false, "progress"_a = 0.0, "subtask"_a = 0,
          nb::sig(
              "def __init__(self, reward: float = 0.0, success: bool = False, progress: float = "
              "0.0, subtask: int = 0) -> None"))
      .def_rw("reward", &TaskVerdict::reward, "Reward of the state.")
      .def_rw("success", &TaskVerdict::success, "True if the task is done.")
      .def_rw("progress", &TaskVerdict::progress, "Progress from 0 at the start to 1 at success.")
      .def_rw("subtask", &TaskVerdict::subtask, "Index into the task's subtasks().")
      .def(
          "__getstate__",
          [](const TaskVerdict& v) {
            return nb::make_tuple(v.reward, v.success, v.progress, v.subtask);
          },
          nb::sig("def __getstate__(self) -> tuple[float, bool, float, int]"))
      .def(
          "__setstate__",
          [](TaskVerdict& v, const std::tuple<double, bool, double, int>& state) {
            const auto& [reward, success, progress, subtask] = state;
            new (&v) TaskVerdict{reward, success, progress, subtask};
          },
          nb::sig("def __setstate__(self, state: tuple[float, bool, float, int]) -> None"))
      .def("__repr__", [](const TaskVerdict& v) {
        return fmt::format("TaskVerdict(reward={:g}, success={}, progress={:g}, subtask={})",
                           v.reward, v.success ? "True" : "False", v.progress, v.subtask);
      });
  nb::class_<TaskSetting>(m, "TaskSetting",
                          "The setting of a task beside its scene: the place's name for messages, "
                          "the robots that act, and the places of objects.")
      .def_ro("place", &TaskSetting::place, "Name in messages: \"environment 'duo'\".")
      .def_ro("robots", &TaskSetting::robots, "Names of the robots that act.")
      .def_prop_ro(
          "objects",
          [](const TaskSetting& setting) {
            nb::dict poses;
            for (const auto& [name, pose] : setting.objects) poses[name.c_str()] = pose;
            return poses;
          },
          nb::sig("def objects(self) -> dict[str, Pose]"),
          "Places of objects in the root frame, by name.");
  nb::class_<StartTurn>(m, "StartTurn",
                        "The number of a start in its run: its scene, and its episode there."
                        "\n\nExamples:\n"
                        "    >>> turns = [rc.tasks.StartTurn(seed=0, scene=0, episode=e) for e in "
                        "range(2)]\n"
                        "    >>> sorted(turn.choose([\"box\", \"mug\"]) for turn in turns)\n"
                        "    ['box', 'mug']")
      .def(
          "__init__",
          [](StartTurn* self, uint64_t seed, int scene, int episode) {
            new (self) StartTurn{seed, scene, episode};
          },
          "seed"_a = 0, "scene"_a = 0, "episode"_a = 0)
      .def_ro("seed", &StartTurn::seed, "Seed of the run.")
      .def_ro("scene", &StartTurn::scene, "Index of the scene in the source.")
      .def_ro("episode", &StartTurn::episode, "Number of the episode in that scene.")
      .def(
          "choose", &StartTurn::Choose, "options"_a,
          "Returns the option whose turn it is: over the episodes of a scene, and over the scenes, "
          "each comes equally often, in an order that changes.");
  nb::class_<BaseRange>(m, "BaseRange", "Range of places of a robot's base around an object.")
      .def(
          "__init__",
          [](BaseRange* self, std::array<double, 2> distance, double height_offset,
             std::array<double, 2> height_noise) {
            new (self) BaseRange{distance, height_offset, height_noise};
          },
          "distance"_a = BaseRange().distance, "height_offset"_a = 0.0,
          "height_noise"_a = BaseRange().height_noise,
          "`distance`: horizontal, smallest and largest, metres; `height_offset`: of the base's "
          "bottom above the object, metres; `height_noise`: added to it, smallest and largest.")
      .def_ro("distance", &BaseRange::distance,
              "Horizontal distance from the object, smallest and largest, metres.")
      .def_ro("height_offset", &BaseRange::height_offset,
              "Height of the base's bottom above the object, metres.")
      .def_ro("height_noise", &BaseRange::height_noise,
              "Smallest and largest height that is added, metres.");
}

// Methods that a subclass may omit call the base class's own.
void BindTaskClass(nb::module_& m) {
  nb::class_<Task, PyTaskOf<Task>>(
      m, "Task",
      "A goal for robots. Subclasses define instruction() and judge(scene) -> TaskVerdict, "
      "or\nreward(scene) and success(scene); all other methods are optional.\n\nprepare adds what "
      "the task needs to the scene, bind follows once the scene\nis compiled. An episode begins "
      "with starts, a reset, arrange and begin. After each step\ncome judge and observe. "
      "`@register_task('stack')` registers a subclass by name."
      "\n\nExamples:\n"
      "    >>> class Lift(rc.tasks.Task):\n"
      "    ...     def instruction(self):\n"
      "    ...         return \"lift the cube\"\n"
      "    ...     def judge(self, scene):\n"
      "    ...         height = scene.body_pose(\"cube\").translation[2]\n"
      "    ...         return rc.tasks.TaskVerdict(reward=height, success=height > 0.1)\n"
      "    >>> Lift().judge(scene).success\n"
      "    False")
      .def(nb::init<>())
      .def(
          "prepare", [](Task&, SceneSpec&, PythonRng&) {}, "spec"_a, "rng"_a,
          "Adds objects, sites or cameras to the SceneSpec. It may be called on a different task "
          "object, with the same fields, than the bound one. Objects without a `pos` get a "
          "position at each start; those with one stay there. `annotations` describes the scene.")
      .def_prop_ro(
          "turn", [](const Task& t) { return t.turn(); },
          "StartTurn of the start in its run, from prepare on: `turn.choose(kinds)` gives each "
          "kind "
          "its turn. In an environment, which is prepared once, that of the first start.")
      .def_prop_ro(
          "annotations",
          [](const Task& t) {
            const nb::gil_scoped_release unlocked;
            return t.annotations();
          },
          "SceneAnnotations of the scene that prepare adds to: those of its source (checked), else "
          "derived from the geometry, which requires compiling. Available in prepare, and "
          "afterwards if prepare read them; otherwise raises Error.")
      .def(
          "bind",
          [](Task& t, const Scene& scene, const TaskSetting& setting) {
            (void)t, (void)scene, (void)setting;
          },
          "scene"_a, "setting"_a, "Called once the scene is compiled, before the first reset.")
      .def(
          "starts", [](Task&, PythonRng&) { return nb::dict(); }, "rng"_a,
          nb::sig("def starts(self, rng: Rng) -> collections.abc.Mapping[str, Pose]"),
          "Returns starts of free and mocap bodies: {name in the scene: pose in the world}. The "
          "reset puts them there with everything else, which is several times as fast as moving "
          "them in arrange.\n\nThe scene is still in the state of the last episode: do not read it "
          "here; use arrange for what depends on it.")
      .def(
          "arrange", [](Task&, const Scene&, PythonRng&) { return nb::none(); }, "scene"_a, "rng"_a,
          nb::sig("def arrange(self, scene: Scene, rng: Rng) -> Refusal | None"),
          "Makes the other changes of a start; `rng` continues from starts. A Refusal rejects this "
          "start, and another one is drawn.")
      .def(
          "check_start", [](Task&, const Scene&) { return nb::none(); }, "scene"_a,
          nb::sig("def check_start(self, scene: Scene) -> Refusal | None"),
          "Returns a Refusal for a start from which the task cannot be done: no grasp is in reach "
          "(check_grasps), nothing can be put down at the goal. Another start is drawn after a "
          "Refusal. Runs call it before the objects settle and afterwards, environments once.")
      .def(
          "begin", [](Task&, const Scene&) {}, "scene"_a,
          "Stores the values that success is measured from. The scene is at its start state.")
      .def(
          "judge",
          [](Task& t, const Scene& scene) {
            // A subclass may call it by super(), so that its own judge() is not meant.
            auto* own = dynamic_cast<PyTaskOf<Task>*>(&t);
            return own ? own->JudgeByParts(scene) : t.Judge(scene);
          },
          "scene"_a, "Returns the TaskVerdict of the present state.")
      .def(
          "reward", [](Task& t, const Scene& scene) { return t.Judge(scene).reward; }, "scene"_a,
          "Returns the reward of the present state. judge() calls it in tasks that do not define "
          "judge().")
      .def(
          "success", [](Task& t, const Scene& scene) { return t.Judge(scene).success; }, "scene"_a,
          "Returns True if the task is done in the present state.")
      .def("instruction", &Task::instruction, "Returns the instruction in words.")
      .def(
          "objects", [](const Task&) { return std::vector<std::string>(); },
          nb::sig("def objects(self) -> collections.abc.Sequence[str]"),
          "Returns the names under which the poses of objects are observed and recorded, the "
          "target first.")
      .def(
          "object_of", [](const Task&, const std::string& name) { return name; }, "name"_a,
          "Returns the object of the scene for which a name of objects() stands in the present "
          "episode, the object of that name by default. In an environment, a task that draws its "
          "target among several objects observes it as 'target', as in a run.")
      .def(
          "kind_of", [](const Task&, const std::string& object) { return object; }, "object"_a,
          "Returns the kind of an object that prepare added, its name by default. Reports count by "
          "the kind of the first object, and `start.places` may name it.")
      .def(
          "resting_objects", [](const Task&) { return std::vector<std::string>(); },
          nb::sig("def resting_objects(self) -> collections.abc.Sequence[str]"),
          "Returns objects that must be at rest when an episode begins: no contact with a robot, "
          "no penetration, and support below. starts and arrange are called again, with the "
          "following random numbers, until they are. Creating an environment simulates one start "
          "until they rest.")
      .def(
          "subtasks", [](const Task&) { return std::vector<std::string>(); },
          nb::sig("def subtasks(self) -> collections.abc.Sequence[str]"),
          "Returns the names that TaskVerdict.subtask indexes.")
      .def(
          "why_not_done", [](const Task& t) { return t.Task::why_not_done(); },
          "Returns, in a few words for counting, why an episode of a run that its expert finished "
          "is no success.")
      .def(
          "base_range", [](const Task&) { return BaseRange(); },
          "Returns where the robot's base may stand around the first of objects(), for what the "
          "run "
          "or the environment leaves open.")
      .def(
          "places", [](const Task&) { return nb::dict(); },
          nb::sig("def places(self) -> collections.abc.Mapping[str, ObjectPlace | dict[str, "
                  "typing.Any]]"),
          "Returns which objects start on top of, inside or next to something: {'cube': {'inside': "
          "'tray'}}. The `places` of the run or of the environment come before it. The others lie "
          "on the support.")
      .def(
          "signals", [](const Task&) { return nb::dict(); },
          nb::sig("def signals(self) -> collections.abc.Mapping[str, "
                  "tuple[numpy.typing.ArrayLike, numpy.typing.ArrayLike] | Feature] | "
                  "collections.abc.Sequence[Feature]"),
          "Returns what the task adds to the observation: a list of Feature, with shape, unit, "
          "frame, names and range, or {name: (lower, upper)} for privileged numbers in a row.")
      .def(
          "observe", [](const Task&, const Scene&) { return nb::dict(); }, "scene"_a,
          nb::sig("def observe(self, scene: Scene) -> dict[str, numpy.typing.ArrayLike]"),
          "Returns the signals: {name: numbers}.")
      .def(
          "memory", [](const Task&) { return std::vector<double>(); },
          nb::sig("def memory(self) -> numpy.typing.ArrayLike"),
          "Returns the task's memory of the episode, for saved states. A task without it keeps the "
          "attributes that the episode has set.")
      .def(
          "recall", [](Task&, nb::handle) {}, "memory"_a,
          nb::sig("def recall(self, memory: numpy.typing.NDArray[numpy.float64]) -> None"),
          "Restores the result of memory().");
}

nb::dict InfoDict(const std::string& kind) {
  const ObjectInfo info = ObjectInfoOf(kind);
  nb::list grasps;
  for (const ObjectGrasp grasp : info.grasps) grasps.append(ToString(grasp));
  nb::dict words;
  words["category"] = info.category;
  words["colour"] = info.colour;
  words["material"] = info.material;
  words["synonyms"] = info.synonyms.names;
  words["size"] = info.size ? nb::object(nb::cast(*info.size)) : nb::none();
  words["grasps"] = grasps;
  words["drawn_by_default"] = info.drawn_by_default;
  return words;
}

}  // namespace

void BindTask(nb::module_& m) {
  nb::class_<PythonRng>(
      m, "Rng",
      "A keyed random stream: the same keys give the same numbers on every machine.\n\nA stream "
      "passed to your function is valid for that call only; fork it to keep one."
      "\n\nExamples:\n"
      "    >>> rng = rc.tasks.Rng.stream(0, \"start\")\n"
      "    >>> 0.1 <= rng.uniform(0.1, 0.2) < 0.2\n"
      "    True")
      .def_static(
          "stream",
          [](uint64_t seed, const std::string& purpose) {
            return PythonRng(Rng::Stream(seed, purpose));
          },
          "seed"_a, "purpose"_a,
          "Makes the stream of a seed and a purpose; other purposes give independent streams.")
      .def(
          "uniform",
          [](PythonRng& r, double lower, double upper) { return r.get().Uniform(lower, upper); },
          "lower"_a = 0.0, "upper"_a = 1.0, "Draws from [lower, upper).")
      .def(
          "integer", [](PythonRng& r, uint64_t count) { return r.get().UniformInt(count); },
          "count"_a, "Draws one of 0 ... count - 1.")
      .def(
          "normal", [](PythonRng& r) { return r.get().Normal(); },
          "Draws from the normal distribution with mean 0 and deviation 1.")
      .def(
          "fork",
          [](PythonRng& r, const std::string& purpose) { return PythonRng(r.get().Fork(purpose)); },
          "purpose"_a, "Returns an independent stream, which may be kept.");
  BindTaskParts(m);
  BindTaskClass(m);
  nb::class_<Expert, PyExpertOf<Expert>>(
      m, "Expert",
      "Acts from the simulation's state. Subclasses define begin(scene, rng), act(scene, rng) -> "
      "{robot: {group: GroupCommand}},\ndone(), failure(), phase(), phase_names()."
      "\n\nExamples:\n"
      "    >>> class Wait(rc.tasks.Expert):\n"
      "    ...     def act(self, scene, rng):\n"
      "    ...         q = scene.robot(\"arm\").jnt_pos_msr\n"
      "    ...         return {\"arm\": {\"arm\": rc.control.GroupCommand.joints(q)}}\n"
      "    >>> commands = Wait().act(scene, rc.tasks.Rng.stream(0, \"wait\"))")
      .def(nb::init<>())
      .def(
          "begin", [](Expert& e, const Scene& s, PythonRng& rng) { e.Begin(s, rng.get()); },
          "scene"_a, "rng"_a, "Plans from the start state of an episode.")
      .def(
          "act", [](Expert& e, const Scene& s, PythonRng& rng) { return e.Act(s, rng.get()); },
          "scene"_a, "rng"_a, "Returns {robot: {group: GroupCommand}} until the next policy tick.")
      .def(
          "see", [](Expert&, nb::handle) {}, "row"_a,
          nb::sig("def see(self, row: dict[str, numpy.typing.NDArray[typing.Any]]) -> None"),
          "Called before each act() with the recorded row of the state, for experts that only use "
          "recorded data: columns and images by their names in a dataset. Images are drawn when "
          "one of "
          "them is first read; read them before act() returns.")
      .def("done", &Expert::done,
           "Returns True when the expert has finished; the rollout then ends.")
      .def("failure", &Expert::failure,
           "Returns why the expert gave up, \"\" otherwise. A rollout that ends with a failure is "
           "not a success, even if its task judges it as one.")
      .def(
          "ends_at_success", [](const Expert&) { return false; },
          "Returns True if a rollout ends as soon as the task succeeds; for policies, which cannot "
          "tell.")
      .def("phase", &Expert::phase, "Returns the index of the present phase in phase_names().")
      .def("phase_names", &Expert::phase_names,
           "Returns the names of the phases, which episodes record as labels.")
      .def(
          "results_json", [](const Expert& e) { return e.Expert::results_json(); },
          "Returns what the episode's results record of the expert, a JSON object as text. Asked "
          "once, at the end of the episode."
          "\n\nExamples:\n"
          "    >>> class Counting(rc.tasks.Expert):\n"
          "    ...     def results_json(self):\n"
          "    ...         return '{\"grasps\": 2}'\n"
          "    >>> Counting().results_json()\n"
          "    '{\"grasps\": 2}'");
  m.def("object_kinds", &ObjectKinds,
        "Returns all kinds of objects that tasks can use: primitives, and the built-in objects and "
        "those of users.");
  m.def("default_object_kinds", &DefaultObjectKinds,
        "Returns the kinds of objects that tasks draw unless they name some.");
  m.def("object_categories", &ObjectCategories,
        "Returns the categories of objects and the kinds of each: {category: kinds}.");
  m.def("object_kinds_of", &ObjectKindsOf, "names"_a,
        "Returns `names` with categories replaced by their kinds, each kind once."
        "\n\nExamples:\n"
        "    >>> rc.tasks.object_kinds_of([\"mug\", \"fruit\"])[:2]\n"
        "    ['mug', 'apple']");
  m.def("object_info", &InfoDict, "kind"_a,
        nb::sig("def object_info(kind: str) -> dict[str, typing.Any]"),
        "Returns what object.yaml beside the model of a kind or of equipment says: `category`, "
        "`colour`, `material`, "
        "`synonyms`, `size` (metres, or None), `grasps` and `drawn_by_default`."
        "\n\nRaises NotFoundError for an unknown kind, and SpecError for a file with faults."
        "\n\nExamples:\n"
        "    >>> rc.tasks.object_info(\"apple\")[\"category\"]\n"
        "    'fruit'");
  m.def(
      "make_object",
      [](const std::string& kind, const std::string& name, PythonRng& rng) {
        return MakeCatalogueObject(kind, name, rng.get());
      },
      "kind"_a, "name"_a, "rng"_a,
      "Returns a SceneObject of a kind of the catalogue (object_kinds), of random size where the "
      "kind has sizes, without a pose. For prepare of a Task."
      "\n\nExamples:\n"
      "    >>> rng = rc.tasks.Rng.stream(0, \"object\")\n"
      "    >>> rc.tasks.make_object(\"mug\", \"target\", rng).name\n"
      "    'target'");
}

}  // namespace robocell::python
