// Tasks of environments that are written in Python, and their registry.
//
// The functions that make them are kept in a dictionary of the module: C++ holds names only, so
// that nothing of Python outlives it.
#include "robocell/env/env_task.h"

#include <fmt/format.h>
#include <nanobind/trampoline.h>

#include "bindings.h"
#include "body_poses.h"
#include "env.h"
#include "python_owner.h"
#include "returned.h"
#include "rng.h"
#include "values.h"
#include "robocell/base/error.h"

namespace robocell::python {

using namespace nb::literals;

namespace {

constexpr const char* kFactories = "_env_tasks";

// What a method that need not be there gives.
template <class R, class... Args>
R CallOr(const nb::detail::trampoline& trampoline, const char* name, R otherwise, Args... args) {
  const nb::detail::ticket call(trampoline, name, nb::detail::str_hash(name), false);
  if (!call.key.is_valid()) return otherwise;
  return Returned<R>(trampoline.base(), name, trampoline.base().attr(call.key)(args...));
}

template <class R, class... Args>
R CallRequired(const nb::detail::trampoline& trampoline, const char* name, Args... args) {
  const nb::detail::ticket call(trampoline, name, nb::detail::str_hash(name), false);
  if (!call.key.is_valid()) ThrowMissing(trampoline.base(), name);
  return Returned<R>(trampoline.base(), name, trampoline.base().attr(call.key)(args...));
}

// "MyTask.signals()", for messages.
std::string MethodText(nb::handle self, const char* method) {
  return ClassName(self) + "." + method + "()";
}

class PyEnvTask : public EnvTask {
 public:
  NB_TRAMPOLINE(EnvTask);

  BodyPoses Starts(Rng& rng) override {
    const nb::detail::ticket call(nb_trampoline, "starts", nb::detail::str_hash("starts"), false);
    if (!call.key.is_valid()) return {};
    const RngLoan loan(rng);
    const std::string text = MethodText(nb_trampoline.base(), "starts");
    return ToBodyPoses(nb_trampoline.base().attr(call.key)(loan.rng()), FieldPath(text));
  }
  void Arrange(Scene& scene, Rng& rng) override {
    const nb::detail::ticket call(nb_trampoline, "arrange", nb::detail::str_hash("arrange"), false);
    if (!call.key.is_valid()) return;
    const RngLoan loan(rng);
    nb_trampoline.base().attr(call.key)(Scene(scene), loan.rng());
  }
  void Begin(const Scene& scene) override {
    const nb::detail::ticket call(nb_trampoline, "begin", nb::detail::str_hash("begin"), false);
    if (call.key.is_valid()) nb_trampoline.base().attr(call.key)(Scene(scene));
  }
  double Reward(const Scene& scene) override {
    return CallRequired<double>(nb_trampoline, "reward", Scene(scene));
  }
  bool Success(const Scene& scene) override {
    return CallRequired<bool>(nb_trampoline, "success", Scene(scene));
  }
  std::string instruction() const override {
    return CallRequired<std::string>(nb_trampoline, "instruction");
  }
  std::vector<std::string> objects() const override {
    return CallOr<std::vector<std::string>>(nb_trampoline, "objects", {});
  }

  std::vector<std::string> resting_objects() const override {
    return CallOr<std::vector<std::string>>(nb_trampoline, "resting_objects", {});
  }

  std::vector<TaskSignal> signals() const override {
    const nb::detail::ticket call(nb_trampoline, "signals", nb::detail::str_hash("signals"), false);
    if (!call.key.is_valid()) return {};
    const std::string text = MethodText(nb_trampoline.base(), "signals");
    const FieldPath path(text);
    const nb::object made = nb_trampoline.base().attr(call.key)();
    nb::dict ranges;
    if (!nb::try_cast(made, ranges)) ThrowType(path, "a dict of names to (lower, upper)", made);
    std::vector<TaskSignal> signals;
    for (const auto& [key, value] : ranges) {
      const std::string name = ToText(key, path);
      const FieldPath of_signal(path, name);
      const std::vector<nb::object> pair = ToItems(value, of_signal, "a pair (lower, upper)");
      if (pair.size() != 2) ThrowType(of_signal, "a pair (lower, upper)", value);
      const Numbers lower(pair[0], of_signal), upper(pair[1], of_signal);
      signals.push_back({name,
                         {lower.span().begin(), lower.span().end()},
                         {upper.span().begin(), upper.span().end()}});
    }
    sizes_.clear();
    for (const TaskSignal& signal : signals) sizes_.emplace_back(signal.name, signal.lower.size());
    return signals;
  }

  void Observe(const Scene& scene, std::span<double> out) const override {
    const nb::detail::ticket call(nb_trampoline, "observe", nb::detail::str_hash("observe"), false);
    if (!call.key.is_valid()) ThrowMissing(nb_trampoline.base(), "observe");
    const std::string text = MethodText(nb_trampoline.base(), "observe");
    const FieldPath path(text);
    const nb::object made = nb_trampoline.base().attr(call.key)(Scene(scene));
    nb::dict values;
    if (!nb::try_cast(made, values)) ThrowType(path, "a dict of signals", made);
    for (const auto& [name, size] : sizes_) {
      if (!values.contains(name.c_str()))
        ThrowValue(path, fmt::format("has no '{}', which signals() names", name));
      const nb::object value = values[name.c_str()];
      const Numbers numbers(value, FieldPath(path, name), size);
      std::copy(numbers.span().begin(), numbers.span().end(), out.begin());
      out = out.subspan(size);
    }
  }

  std::vector<double> memory() const override {
    const nb::detail::ticket call(nb_trampoline, "memory", nb::detail::str_hash("memory"), false);
    if (!call.key.is_valid()) return {};
    const std::string text = MethodText(nb_trampoline.base(), "memory");
    const Numbers numbers(nb_trampoline.base().attr(call.key)(), FieldPath(text));
    return {numbers.span().begin(), numbers.span().end()};
  }
  void Recall(std::span<const double> memory) override {
    const nb::detail::ticket call(nb_trampoline, "recall", nb::detail::str_hash("recall"), false);
    if (call.key.is_valid()) nb_trampoline.base().attr(call.key)(NumberCopy(memory));
  }

 private:
  mutable std::vector<std::pair<std::string, size_t>> sizes_;  // of the signals
};

nb::dict PythonTasks() {
  return nb::cast<nb::dict>(nb::module_::import_("robocell._core").attr(kFactories));
}

std::shared_ptr<EnvTask> MakePythonTask(const std::string& kind, const EnvConfig& config,
                                        const Scene& scene) {
  const nb::gil_scoped_acquire acquire;
  const nb::object factory = PythonTasks()[kind.c_str()];
  const nb::object made = factory(EnvConfig(config), Scene(scene));
  if (!nb::isinstance<EnvTask>(made))
    ThrowReturned("the function of task '" + kind + "'", "an EnvTask", made);
  return Shared<EnvTask>(made);
}

void RegisterPythonTask(const std::string& kind, nb::object factory) {
  if (!PyCallable_Check(factory.ptr()))
    ThrowType(FieldPath("factory"), "a function (config, scene) -> EnvTask, or its class", factory);
  nb::dict tasks = PythonTasks();
  // Python's own may be replaced, as when a notebook's cell is run again.
  if (!tasks.contains(kind.c_str())) {
    RegisterEnvTask(kind, [kind](const EnvConfig& config, const Scene& scene) {
      return MakePythonTask(kind, config, scene);
    });
  }
  tasks[kind.c_str()] = factory;
}

}  // namespace

PyObject* TargetOfTask(const Env& env) {
  return env.task().use_count() == 1 ? TargetOf(env.task()) : nullptr;
}

void BindEnvTask(nb::module_& m) {
  m.attr(kFactories) = nb::dict();
  nb::class_<EnvTask, Task, PyEnvTask>(
      m, "EnvTask",
      "What an environment is about. Subclass it with reward(scene), success(scene) and\n"
      "instruction(), and as needed starts(rng) -> {name: Pose}, where bodies of the scene start,\n"
      "arrange(scene, rng), which does what else an episode starts with, begin(scene), objects()\n"
      "(ids of the objects to observe), signals() -> {name: (lower, upper)} with observe(scene) "
      "->\n"
      "{name: numbers}, and memory() -> numbers with recall(numbers), for going back to saved\n"
      "states.\n\n"
      "register_env_task('mine', Mine) makes it known; EnvConfig(task={'kind': 'mine'}) uses it. "
      "It is made as Mine(config, scene).")
      .def(nb::init<>())
      // What a subclass need not define; they also tell nanobind where to look for overrides.
      .def(
          "starts", [](EnvTask&, PythonRng&) { return nb::dict(); }, "rng"_a,
          nb::sig("def starts(self, rng: Rng) -> collections.abc.Mapping[str, Pose]"),
          "Where free and mocap bodies start: {name in the scene: pose in the world}. The reset "
          "puts them there with all else, which is several times as fast as moving them in "
          "arrange.\n\nThe scene is still where the last episode ended: do not look at it; what "
          "depends on it belongs into arrange.")
      .def(
          "arrange", [](EnvTask&, const Scene&, PythonRng&) {}, "scene"_a, "rng"_a,
          "What else an episode starts with; `rng` goes on from starts.")
      .def(
          "resting_objects", [](const EnvTask&) { return std::vector<std::string>(); },
          nb::sig("def resting_objects(self) -> collections.abc.Sequence[str]"),
          "Ids of objects that have to lie still when an episode begins: touching no robot, inside "
          "of nothing and with something under them. starts and arrange are called again, with the "
          "numbers that follow, until they do. When the environment is made one start is tried, "
          "and simulated until they rest.")
      .def(
          "signals", [](const EnvTask&) { return nb::dict(); },
          nb::sig("def signals(self) -> dict[str, tuple[numpy.typing.ArrayLike, "
                  "numpy.typing.ArrayLike]]"),
          "What is added to the observation: {name: (lower, upper)}.")
      .def(
          "observe", [](const EnvTask&, const Scene&) { return nb::dict(); }, "scene"_a,
          nb::sig("def observe(self, scene: Scene) -> dict[str, numpy.typing.ArrayLike]"),
          "The signals: {name: numbers}.")
      .def(
          "memory", [](const EnvTask&) { return std::vector<double>(); },
          nb::sig("def memory(self) -> numpy.typing.ArrayLike"),
          "What it remembers of the episode, for saved states.")
      .def(
          "recall", [](EnvTask&, nb::handle) {}, "memory"_a,
          nb::sig("def recall(self, memory: numpy.typing.NDArray[numpy.float64]) -> None"),
          "Takes what memory() gave.")
      .def(
          "begin", [](EnvTask&, const Scene&) {}, "scene"_a, "Called when all is in its place.")
      .def(
          "objects", [](const EnvTask&) { return std::vector<std::string>(); },
          "Ids of the objects that are observed.");
  m.def("register_env_task", &RegisterPythonTask, "kind"_a, "factory"_a,
        nb::sig("def register_env_task(kind: str, factory: collections.abc.Callable[[EnvConfig, "
                "Scene], EnvTask]) -> None"),
        "Makes a task known by a name, for environments of this process. A class will do for the "
        "function. Registering a name again replaces it, unless it is one of robocell's own.");
  m.def("env_task_kinds", &EnvTaskKinds, "Names for EnvTaskConfig.kind.");
  BindEnvState(m);
}

}  // namespace robocell::python
