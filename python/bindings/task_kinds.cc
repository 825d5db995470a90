// Kinds of tasks and experts that are written in Python.
//
// The functions that make them are kept in dictionaries of the module: C++ only has names, so that
// no Python object outlives the module.
#include "robocell/task/task_kind.h"

#include <nanobind/stl/tuple.h>

#include <exception>
#include <utility>

#include "bindings.h"
#include "env.h"
#include "number_like.h"
#include "python_hooks.h"
#include "python_owner.h"
#include "returned.h"
#include "sampler.h"
#include "scene_sharing.h"
#include "values.h"
#include "robocell/base/error.h"
#include "robocell/expert/expert_kind.h"
#include "robocell/scenes/scene_source.h"
#include "robocell/spec/run_config.h"
#include "robocell/spec/value_fields.h"
#include "robocell/task/sampler_kind.h"
#include "robocell/task/task_judge.h"

namespace robocell::python {

using namespace nb::literals;

namespace {

constexpr const char* kTasks = "_tasks";      // kind -> function (fields: dict) -> Task
constexpr const char* kExperts = "_experts";  // kind -> function (run, start) -> Expert
constexpr const char* kSources =
    "_scene_sources";                            // kind -> function (fields: dict) -> SceneSource
constexpr const char* kSamplers = "_samplers";   // kind -> function (run) -> TaskSampler
constexpr const char* kTaskCode = "_task_code";  // kind -> function () -> list of files
constexpr const char* kExpertCode = "_expert_code";  // the same
constexpr const char* kSourceCode = "_scene_source_code";
constexpr const char* kSamplerCode = "_sampler_code";

nb::dict Makers(const char* name) {
  return nb::cast<nb::dict>(nb::module_::import_("robocell._core").attr(name));
}

nb::object ToPython(const ValueField::Value& value) {
  return std::visit([](const auto& of) { return nb::cast(of); }, value);
}

// Returns the present source files that define a task or an expert.
std::vector<std::string> FilesOf(const char* registry, const std::string& kind) {
  const nb::gil_scoped_acquire acquire;
  const nb::dict files = Makers(registry);
  if (!files.contains(kind.c_str())) return {};
  return nb::cast<std::vector<std::string>>(files[kind.c_str()]());
}

// Returns the values of the fields of a kind that has no struct.
nb::dict ValuesOf(const KindSpec& spec) {
  nb::dict fields;
  if (const auto* values = spec.If<ValueFields>()) {
    for (const ValueField& field : values->list())
      fields[field.name.c_str()] = ToPython(field.value);
  }
  return fields;
}

class PythonTaskKind final : public TaskKind {
 public:
  explicit PythonTaskKind(std::string kind) : kind_(std::move(kind)) {}

  std::shared_ptr<Task> Make(const TaskSpec& spec) const override {
    const nb::gil_scoped_acquire acquire;
    const nb::object maker = Makers(kTasks)[kind_.c_str()];
    const nb::object made = CallMaker(maker, ValuesOf(spec));
    if (!nb::isinstance<Task>(made))
      ThrowReturned("the function of task '" + kind_ + "'", "a Task", made, PlaceOfCode(maker));
    return ConvertReturned(made, "__init__", [&] { return Shared<Task>(made); });
  }
  // Asks a task that has no scene for its words: those of one that needs a start are not known yet.
  void ValidateScene(const RunConfig& run, const Scene& /*scene*/, Robot& /*robot*/,
                     Problems& /*problems*/, Problems& doubts) const override {
    try {
      const std::shared_ptr<Task> task = Make(run.task);
      const std::string words = task->instruction();  // rule-ok: its error is not reported here
      const std::string why = WhyNoWords(*task, kind_, words);
      if (!why.empty()) doubts.AddAt("task", why);
    } catch (const std::exception&) {
      return;  // the first start raises the error
    }
  }
  std::vector<std::string> CodeFiles() const override { return FilesOf(kTaskCode, kind_); }

 private:
  std::string kind_;
};

class PythonExpertKind final : public ExpertKind {
 public:
  explicit PythonExpertKind(std::string kind) : kind_(std::move(kind)) {}

  // The arguments and the result may be kept: the arguments are copies that share scene and task,
  // the expert lives as long as either side uses it.
  std::shared_ptr<Expert> Make(const RunConfig& run, const EpisodeStart& start) const override {
    const nb::gil_scoped_acquire acquire;
    const nb::object maker = Makers(kExperts)[kind_.c_str()];
    nb::object made = CallMaker(maker, nb::cast(run), nb::cast(start));
    if (!nb::isinstance<Expert>(made))
      ThrowReturned("the function of expert '" + kind_ + "'", "an Expert", made,
                    PlaceOfCode(maker));
    return ConvertReturned(made, "__init__", [&] { return Shared<Expert>(made); });
  }
  std::vector<std::string> CodeFiles() const override { return FilesOf(kExpertCode, kind_); }

 private:
  std::string kind_;
};

class PythonSceneSourceKind final : public SceneSourceKind {
 public:
  explicit PythonSceneSourceKind(std::string kind) : kind_(std::move(kind)) {}

  std::shared_ptr<SceneSource> Make(const SceneSourceSpec& spec,
                                    const std::string& directory) const override {
    const nb::gil_scoped_acquire acquire;
    const nb::object maker = Makers(kSources)[kind_.c_str()];
    const nb::object made = CallMaker(maker, ValuesOf(spec), directory);
    if (!nb::isinstance<SceneSource>(made))
      ThrowReturned("the function of scene source '" + kind_ + "'", "a SceneSource", made,
                    PlaceOfCode(maker));
    return ConvertReturned(made, "__init__", [&] { return Shared<SceneSource>(made); });
  }
  std::vector<std::string> CodeFiles() const override { return FilesOf(kSourceCode, kind_); }

 private:
  std::string kind_;
};

class PythonSamplerKind final : public SamplerKind {
 public:
  explicit PythonSamplerKind(std::string kind) : kind_(std::move(kind)) {}

  std::shared_ptr<TaskSampler> Make(const RunConfig& run) const override {
    const nb::gil_scoped_acquire acquire;
    const nb::object maker = Makers(kSamplers)[kind_.c_str()];
    const nb::object made = CallMaker(maker, nb::cast(run));
    if (!nb::isinstance<TaskSampler>(made))
      ThrowReturned("the function of sampler '" + kind_ + "'", "a TaskSampler", made,
                    PlaceOfCode(maker));
    return ConvertReturned(made, "__init__", [&] { return Shared<TaskSampler>(made); });
  }
  std::vector<std::string> CodeFiles() const override { return FilesOf(kSamplerCode, kind_); }

 private:
  std::string kind_;
};

// Makes a field from its default; `texts`: an empty list is one of texts.
ValueField ToField(const std::string& name, nb::handle value, const std::string& doc, bool texts) {
  const FieldPath parent("fields of a kind");
  const FieldPath path(parent, name);
  ValueField field{.name = name, .value = false, .doc = doc};
  if (IsBool(value)) {
    field.value = ToBool(value, path);
  } else if (IsNumber(value) && IsWholeNumber(value)) {
    field.value = ToInt(value, path);
  } else if (IsNumber(value)) {
    field.value = ToDouble(value, path);
  } else if (IsText(value)) {
    field.value = ToText(value, path);
  } else if (nb::isinstance<nb::list>(value) || nb::isinstance<nb::tuple>(value)) {
    const std::vector<nb::object> items = ToItems(value, path, "a list of numbers or texts");
    if (items.empty() ? texts : IsText(items[0])) {
      field.value = ToTexts(value, path);
    } else {
      const Numbers numbers(value, path);
      field.value = std::vector<double>(numbers.span().begin(), numbers.span().end());
    }
  } else {
    ThrowType(path, "a default that is a bool, a number, a text, or a list of numbers or texts",
              value);
  }
  return field;
}

std::shared_ptr<const KindFields> ToFields(const nb::list& fields, const char* type_name) {
  std::vector<ValueField> values;
  for (const nb::handle item : fields) {
    const auto [name, value, doc, texts] =
        nb::cast<std::tuple<std::string, nb::object, std::string, bool>>(item);
    values.push_back(ToField(name, value, doc, texts));
  }
  return std::make_shared<ValueFields>(std::move(values), type_name);
}

void RegisterPythonTask(const std::string& kind, nb::object maker, const nb::list& fields,
                        nb::object code) {
  if (!PyCallable_Check(maker.ptr()))
    ThrowType(FieldPath("maker"), "a function (fields) -> Task, or its class", maker);
  nb::dict tasks = Makers(kTasks);
  // Python's own may be replaced, for example when a notebook's cell is run again.
  RegisterTask(kind, ToFields(fields, "task"), std::make_shared<PythonTaskKind>(kind),
               tasks.contains(kind.c_str()));
  tasks[kind.c_str()] = maker;
  Makers(kTaskCode)[kind.c_str()] = code;
}

void RegisterPythonExpert(const std::string& kind, nb::object maker, nb::object code) {
  if (!PyCallable_Check(maker.ptr()))
    ThrowType(FieldPath("maker"), "a function (run, start) -> Expert, or its class", maker);
  nb::dict experts = Makers(kExperts);
  RegisterExpert(kind, std::make_shared<PythonExpertKind>(kind), experts.contains(kind.c_str()));
  experts[kind.c_str()] = maker;
  Makers(kExpertCode)[kind.c_str()] = code;
}

void RegisterPythonSceneSource(const std::string& kind, nb::object maker, const nb::list& fields,
                               nb::object code) {
  nb::dict sources = Makers(kSources);
  RegisterSceneSource(kind, ToFields(fields, "scene source"),
                      std::make_shared<PythonSceneSourceKind>(kind),
                      sources.contains(kind.c_str()));
  sources[kind.c_str()] = maker;
  Makers(kSourceCode)[kind.c_str()] = code;
}

void RegisterPythonSampler(const std::string& kind, nb::object maker, nb::object code) {
  nb::dict samplers = Makers(kSamplers);
  RegisterSampler(kind, std::make_shared<PythonSamplerKind>(kind), samplers.contains(kind.c_str()));
  samplers[kind.c_str()] = maker;
  Makers(kSamplerCode)[kind.c_str()] = code;
}

}  // namespace

bool HasPythonHooks(const EnvConfig& config) {
  const bool has_task = config.task && Makers(kTasks).contains(config.task->kind().c_str());
  return has_task || HasPythonFeature(config.features.names);
}

bool HasPythonHooks(const RunConfig& run) {
  const auto is_made_here = [](const char* registry, const std::string& kind) {
    return !kind.empty() && Makers(registry).contains(kind.c_str());
  };
  return is_made_here(kTasks, run.task.kind()) || is_made_here(kSamplers, run.sampler) ||
         is_made_here(kExperts, NameOfExpert(run)) || HasPythonFeature(run.features.names);
}

DataFactory DataForHooks(bool are_in_python) {
  if (!are_in_python) return {};
  ImportMujoco();  // before the work starts
  return PythonData();
}

PyObject* TargetOfTask(const Env& env) {
  return env.task().use_count() == 1 ? TargetOf(env.task()) : nullptr;
}

void BindTaskKinds(nb::module_& m) {
  m.attr(kTasks) = nb::dict();
  m.attr(kExperts) = nb::dict();
  m.attr(kSources) = nb::dict();
  m.attr(kSamplers) = nb::dict();
  m.attr(kTaskCode) = nb::dict();
  m.attr(kExpertCode) = nb::dict();
  m.attr(kSourceCode) = nb::dict();
  m.attr(kSamplerCode) = nb::dict();
  m.def("_register_task", &RegisterPythonTask, "kind"_a, "maker"_a, "fields"_a, "code"_a);
  m.def("_register_expert", &RegisterPythonExpert, "kind"_a, "maker"_a, "code"_a);
  m.def("_register_scene_source", &RegisterPythonSceneSource, "kind"_a, "maker"_a, "fields"_a,
        "code"_a);
  m.def("_register_sampler", &RegisterPythonSampler, "kind"_a, "maker"_a, "code"_a);
  m.def(
      "scene_source_kinds", [] { return SceneSourceRegistry().kinds(); },
      "Returns the kinds for the `source` of a run's scenes.");
  m.def("sampler_kinds", &SamplerKinds, "Returns the kinds for the `sampler` of a run.");
  m.def(
      "imports_of_run_file",
      [](const std::string& path) {
        std::vector<std::pair<std::string, std::string>> imports;
        for (const RunImport& import : ImportsOfRunFile(path))
          imports.emplace_back(import.name, import.place);
        return imports;
      },
      "path"_a,
      "Returns the `imports` of a run file, each with its place (\"run.yaml:3:11\"); none for a "
      "file that cannot be read.");
  m.def("task_kinds", &TaskKinds, "Returns the kinds for the `task` of a configuration.");
  m.def("expert_kinds", &ExpertKinds, "Returns the kinds of experts.");
  m.def(
      "make_task",
      [](const EnvConfig& config, const Scene& scene) { return MakeTask(config, scene); },
      "config"_a, "scene"_a,
      "Returns the task of an environment's configuration, bound to its scene; None without one.");
  BindEnvState(m);
}

}  // namespace robocell::python
