// Features: the observations and commands of a cell, by name; those of an episode, and a user's
// own.
#include <fmt/format.h>
#include <nanobind/nanobind.h>

#include <algorithm>
#include <mutex>
#include <optional>
#include <utility>

#include "arrays.h"
#include "bindings.h"
#include "features.h"
#include "number_like.h"
#include "python_hooks.h"
#include "python_owner.h"
#include "scene_cycles.h"
#include "task_trampolines.h"
#include "values.h"
#include "robocell/features/cell_features.h"
#include "robocell/features/own_features.h"
#include "robocell/rollout/env_recorder.h"
#include "robocell/task/task_features.h"

namespace nb = nanobind;

namespace robocell::python {

using namespace nb::literals;

namespace {

// Features that the collector can traverse: a task written in Python refers to its script's
// variables, and they are often among them. They have one Scene, so that its own cycles are seen.
class PythonFeatures {
 public:
  // Those of an environment, which owns the task and is kept alive.
  explicit PythonFeatures(nb::object env)
      : env_(std::move(env)),
        scene_(nb::cast<const Env&>(env_).scene()),
        features_(RecordedFeatures(nb::cast<const Env&>(env_))) {}
  // `task`: a Task or None.
  PythonFeatures(const Scene& scene, nb::object task, const std::vector<std::string>& own)
      : scene_(scene) {
    if (!task.is_none()) task_ = Shared<Task>(std::move(task));
    const Scene inner = scene.inner();
    const std::shared_ptr<const Task> lent(std::shared_ptr<void>(), task_.get());
    features_.emplace(FeaturesOfCell(inner, RobotsOf(inner), lent, own));
  }
  CellFeatures& get() {
    if (!features_) throw Error("the features of scene '" + scene_.name() + "' are gone");
    return *features_;
  }

  static int Traverse(PyObject* self, visitproc visit, void* arg) {
    Py_VISIT(Py_TYPE(self));
    const auto [ready, is_own] = nb::inst_state(self);
    if (!ready || !is_own) return 0;
    const PythonFeatures& features = *nb::inst_ptr<PythonFeatures>(self);
    Py_VISIT(features.env_.ptr());
    Py_VISIT(TargetOf(features.task_));
    return VisitScene(features.scene_, visit, arg);
  }
  static int Clear(PyObject* self) {
    if (!nb::inst_ready(self)) return 0;
    auto& features = *nb::inst_ptr<PythonFeatures>(self);
    features.features_.reset();
    features.task_.reset();
    features.env_.reset();
    return 0;
  }

 private:
  nb::object env_;
  Scene scene_;
  std::shared_ptr<Task> task_;  // null without one, and for that of an environment
  std::optional<CellFeatures> features_;
};

PyType_Slot features_slots[] = {
    {Py_tp_traverse, reinterpret_cast<void*>(&PythonFeatures::Traverse)},
    {Py_tp_clear, reinterpret_cast<void*>(&PythonFeatures::Clear)},
    {0, nullptr}};

constexpr const char* kFeatures = "_features";  // name -> function (scene) -> numbers

nb::dict FeatureFunctions() {
  return nb::cast<nb::dict>(nb::module_::import_("robocell._core").attr(kFeatures));
}

}  // namespace

nb::dict ToArrays(const FeatureSchema& schema, std::span<const double> numbers) {
  nb::dict arrays;
  for (const Feature& feature : schema.features()) {
    const auto size = static_cast<size_t>(feature.size());
    nb::object array = NumberCopy(numbers.first(size));
    nb::list shape;
    for (const int64_t axis : feature.column.shape) shape.append(axis);
    arrays[feature.column.name.c_str()] = array.attr("reshape")(nb::tuple(shape));
    numbers = numbers.subspan(size);
  }
  return arrays;
}

namespace {

// Returns the shape of a value, () for a number; unset for an iterable that only its reader knows.
std::optional<std::vector<int64_t>> ShapeOf(nb::handle value) {
  if (IsNumber(value) || IsBool(value)) return std::vector<int64_t>();
  const bool is_list = nb::isinstance<nb::list>(value) || nb::isinstance<nb::tuple>(value);
  if (!is_list && !nb::hasattr(value, "__array__")) return std::nullopt;
  try {
    std::vector<int64_t> shape;
    for (nb::handle axis : nb::module_::import_("numpy").attr("shape")(value))
      shape.push_back(nb::cast<int64_t>(axis));
    return shape;
  } catch (const nb::python_error&) {
    return std::nullopt;  // rows of different lengths, for example
  }
}

}  // namespace

void PutValues(nb::handle value, const std::vector<int64_t>& shape, const FieldPath& path,
               std::span<double> out) {
  const std::optional<std::vector<int64_t>> found = ShapeOf(value);
  const bool is_one = found && found->size() <= 1 && shape.size() <= 1 && out.size() == 1 &&
                      RowValues(*found) == 1;  // a number, or a row of one
  if (found && *found != shape && !is_one) {
    ThrowValue(path, fmt::format("has shape {}, and {} was declared; return that shape, or declare "
                                 "the other one",
                                 robocell::ShapeText(*found), robocell::ShapeText(shape)));
  }
  if (IsBool(value)) {
    out[0] = ToBool(value, path) ? 1 : 0;
    return;
  }
  const nb::object row = Ravel(value);
  const Numbers numbers(row, path, out.size());
  std::copy(numbers.span().begin(), numbers.span().end(), out.begin());
}

nb::object Ravel(nb::handle value) {
  const auto is_row = [](nb::handle item) {
    return nb::isinstance<nb::list>(item) || nb::isinstance<nb::tuple>(item);
  };
  const bool is_number = PyFloat_Check(value.ptr()) || PyLong_Check(value.ptr());
  const bool is_nested = is_row(value) && nb::len(value) > 0 && is_row(value[0]);
  if (!is_number && !is_nested && !nb::hasattr(value, "__array__")) return nb::borrow(value);
  try {
    return nb::module_::import_("numpy").attr("ravel")(value);
  } catch (const nb::python_error&) {
    return nb::borrow(value);  // rows of different lengths, for example
  }
}

bool IsByName(nb::handle action) {
  if (!nb::hasattr(action, "keys")) return false;
  std::string column, robot, name;
  for (const nb::handle key : action) {
    if (!nb::try_cast(key, name)) continue;
    if (name.starts_with("robots/"))
      column = name;
    else if (name.find('/') == std::string::npos)
      robot = name;
  }
  if (!column.empty() && !robot.empty()) {
    throw ArgumentError(fmt::format(
        "an action has one form, and this one has two: '{}' is the name of a column, '{}' is not. "
        "Give all commands by the names of columns, or none",
        column, robot));
  }
  return !column.empty();
}

nb::object NamedRow(const nb::dict& row) {
  return nb::module_::import_("robocell._row").attr("NamedColumns")(row);
}

std::map<std::string, std::vector<double>> ToNumbersByName(const nb::dict& values) {
  std::map<std::string, std::vector<double>> numbers;
  const FieldPath path("action");
  for (const auto& [key, value] : values) {
    const std::string name = ToText(key, path);
    const bool is_single =
        nb::hasattr(value, "ndim") ? nb::cast<int>(value.attr("ndim")) == 0 : IsNumber(value);
    const nb::object flat = is_single ? Ravel(value) : nb::borrow(value);
    const Numbers read(flat, FieldPath(path, name));
    numbers[name] = {read.span().begin(), read.span().end()};
  }
  return numbers;
}

namespace {

FeatureRole ToRole(const std::string& text) {
  for (const FeatureRole role : {FeatureRole::kObservation, FeatureRole::kPrivileged,
                                 FeatureRole::kAction, FeatureRole::kLabel}) {
    if (NameOf(role) == text) return role;
  }
  ThrowValue(FieldPath("role"), "is 'observation' or 'privileged', got '" + text + "'");
}

void RegisterPythonFeature(const std::string& name, nb::object function, Feature feature,
                           nb::object code) {
  if (!PyCallable_Check(function.ptr()))
    ThrowType(FieldPath("function"), "a function (scene) -> numbers", function);
  nb::dict functions = FeatureFunctions();
  // Python's own may be replaced, for example when a notebook's cell is run again.
  const bool replace = functions.contains(name.c_str());
  const std::vector<int64_t> shape = feature.column.shape;
  RegisterFeature(name, std::move(feature),
                  [name, shape](const Scene& scene, std::span<double> out) {
                    const nb::gil_scoped_acquire acquire;
                    const nb::object read = FeatureFunctions()[name.c_str()];
                    try {
                      const nb::object made = read(nb::cast(scene));
                      const std::string text = "feature '" + name + "'";
                      PutValues(made, shape, FieldPath(text), out);
                    } catch (nb::python_error&) {
                      RethrowRaised(PlaceOfCode(read));
                    } catch (...) {
                      RethrowAsHookError(PlaceOfCode(read));
                    }
                  },
                  replace,
                  {.files =
                       [name] {
                         const nb::gil_scoped_acquire acquire;
                         return nb::cast<std::vector<std::string>>(
                             FeatureFunctions()[(name + "/code").c_str()]());
                       },
                   .place =
                       [name] {
                         const nb::gil_scoped_acquire acquire;
                         return PlaceOfCode(FeatureFunctions()[name.c_str()]);
                       }});
  functions[name.c_str()] = function;
  functions[(name + "/code").c_str()] = code;
}

}  // namespace

void PutImage(nb::dict& arrays, const CellImage& image) {
  const auto height = static_cast<size_t>(image.height), width = static_cast<size_t>(image.width);
  if (!image.rgb.empty())
    arrays[image.name.c_str()] = NewArray(std::span<const uint8_t>(image.rgb), {height, width, 3});
  if (!image.depth_mm.empty())
    arrays[(image.name + ".depth").c_str()] =
        NewArray(std::span<const uint16_t>(image.depth_mm), {height, width});
  if (!image.bodies.empty())
    arrays[(image.name + ".segmentation").c_str()] =
        NewArray(std::span<const uint16_t>(image.bodies), {height, width});
}

nb::dict RowArrays(const CellRow& row) {
  nb::dict arrays = ToArrays(row.observed, row.numbers);
  for (const CellImage& image : row.images.images()) PutImage(arrays, image);
  return arrays;
}

struct RowLoan::Lent {
  std::mutex mutex;
  std::optional<CellRow> row;  // unset when the loan has ended
};

nb::object RowLoan::Lend(const CellRow& row) {
  nb::list names;
  for (const CellImage& image : row.images.drawn()) {
    names.append(nb::str(image.name.c_str()));
    if (!image.depth_mm.empty()) names.append(nb::str((image.name + ".depth").c_str()));
    if (!image.bodies.empty()) names.append(nb::str((image.name + ".segmentation").c_str()));
  }
  if (!IsLaidOut(row.observed)) LayOut(row.observed);
  if (names.empty()) return make_(NumberCopy(row.numbers), layout_, names, nb::none());
  lent_ = std::make_shared<Lent>();
  lent_->row.emplace(row);
  const auto read = [lent = lent_] {
    std::optional<std::vector<CellImage>> images;
    {
      const nb::gil_scoped_release release;  // drawing takes long
      const std::lock_guard lock(lent->mutex);
      if (lent->row) images = lent->row->images.images();
    }
    if (!images) return nb::object(nb::none());
    nb::dict arrays;
    for (const CellImage& image : *images) PutImage(arrays, image);
    return nb::object(arrays);
  };
  return make_(NumberCopy(row.numbers), layout_, names, nb::cpp_function(read));
}

bool RowLoan::IsLaidOut(const FeatureSchema& schema) const {
  return layout_.is_valid() &&
         std::ranges::equal(
             schema.features(), laid_out_, [](const Feature& feature, const NamedShape& known) {
               return feature.column.name == known.name && feature.column.shape == known.shape;
             });
}

void RowLoan::LayOut(const FeatureSchema& schema) {
  laid_out_.clear();
  make_ = nb::module_::import_("robocell._row").attr("Row").attr("of");
  nb::dict places;
  size_t start = 0;
  for (const Feature& feature : schema.features()) {
    const size_t end = start + static_cast<size_t>(feature.size());
    places[feature.column.name.c_str()] =
        nb::make_tuple(start, end, nb::tuple(nb::cast(feature.column.shape)));
    laid_out_.push_back({feature.column.name, feature.column.shape});
    start = end;
  }
  layout_ = nb::module_::import_("robocell._row").attr("Layout")(places);
}

void RowLoan::End() {
  if (!lent_) return;
  const std::lock_guard lock(lent_->mutex);
  lent_->row.reset();
}

bool HasPythonFeature(const std::vector<std::string>& names) {
  const nb::dict functions = FeatureFunctions();
  return std::ranges::any_of(
      names, [&](const std::string& name) { return functions.contains(name.c_str()); });
}

nb::list FeatureList(const FeatureSchema& schema) {
  nb::list list;
  for (const Feature& feature : schema.features()) list.append(nb::cast(feature));
  return list;
}

void BindFeatures(nb::module_& m) {
  m.attr(kFeatures) = nb::dict();
  nb::class_<Feature>(m, "Feature", "One named quantity of a cell, with unit, frame and source.")
      .def(
          "__init__",
          [](Feature* self, const std::string& name, std::vector<int64_t> shape,
             const std::string& unit, const std::string& frame, std::vector<std::string> names,
             bool privileged, std::vector<double> lower, std::vector<double> upper,
             const std::string& description) {
            new (self)
                Feature{.column = {.name = name,
                                   .shape = std::move(shape),
                                   .units = unit,
                                   .frame = frame,
                                   .names = std::move(names),
                                   .description = description},
                        .role = privileged ? FeatureRole::kPrivileged : FeatureRole::kObservation,
                        .lower = std::move(lower),
                        .upper = std::move(upper)};
            FeatureSchema().Add(*self);  // its checks
          },
          "name"_a, nb::kw_only(), "shape"_a = std::vector<int64_t>(), "units"_a = "",
          "frame"_a = "", "names"_a = std::vector<std::string>(), "privileged"_a = false,
          "lower"_a = std::vector<double>(), "upper"_a = std::vector<double>(),
          "description"_a = "",
          "Creates a feature for the signals() of a task; the arguments are those of "
          "register_feature.")
      .def_prop_ro(
          "name", [](const Feature& f) { return f.column.name; },
          "Name of the feature, which is that of its column in episodes.")
      .def_prop_ro(
          "role", [](const Feature& f) { return std::string(NameOf(f.role)); },
          "\"observation\", \"privileged\" (only simulation knows it), \"action\" or \"label\".")
      .def_prop_ro(
          "dtype", [](const Feature& f) { return std::string(NameOf(f.column.type)); },
          "Type of the numbers in NumPy's terms: \"float64\", \"bool\".")
      .def_prop_ro(
          "shape",
          [](const Feature& f) {
            nb::list shape;
            for (const int64_t axis : f.column.shape) shape.append(axis);
            return nb::tuple(shape);
          },
          nb::sig("def shape(self) -> tuple[int, ...]"),
          "Shape of one row; () for a single number.")
      .def_prop_ro(
          "units", [](const Feature& f) { return f.column.units; },
          "Unit, \"rad\", or one for each component, \"m, 1\".")
      .def_prop_ro(
          "frame", [](const Feature& f) { return f.column.frame; },
          "Frame that the numbers are expressed in: \"world\"; \"\" if they have none.")
      .def_prop_ro(
          "names", [](const Feature& f) { return f.column.names; },
          "Names of the numbers along the last axis.")
      .def_prop_ro(
          "values", [](const Feature& f) { return f.column.values; },
          "Meaning of 0, 1, ... for an integer.")
      .def_prop_ro(
          "description", [](const Feature& f) { return f.column.description; },
          "A sentence, if the name is not enough.")
      .def_prop_ro(
          "lower", [](const Feature& f) { return f.lower; },
          "Smallest value of each number; empty without a range.")
      .def_prop_ro(
          "upper", [](const Feature& f) { return f.upper; },
          "Largest value of each number; empty without a range.")
      .def_prop_ro(
          "source", [](const Feature& f) { return f.source; }, "Source of the feature.")
      .def(
          "difference_from",
          [](const Feature& own, const Feature& other) {
            FeatureSchema a, b;
            a.Add(own);
            b.Add(other);
            return a.DifferenceFrom(b, "in one", "in the other");
          },
          "other"_a,
          "Compares two features without their ranges. Returns '' if they are the same, else the "
          "difference in words.")
      .def(
          "__getstate__",
          [](const Feature& f) {
            FeatureSchema one;
            one.Add(f);
            return one.ToJson();
          },
          nb::sig("def __getstate__(self) -> str"))
      .def(
          "__setstate__",
          [](Feature& f, const std::string& json) {
            const FeatureSchema one = FeatureSchema::FromJson(json);
            if (one.features().size() != 1)
              throw ArgumentError("the state of a Feature describes one feature");
            new (&f) Feature(one.features().front());
          },
          nb::sig("def __setstate__(self, state: str) -> None"))
      .def("__repr__", [](const Feature& f) {
        const std::string unit = f.column.units.empty() ? "" : " in " + f.column.units;
        return fmt::format("<Feature '{}': {} {}{}>", f.column.name, NameOf(f.role),
                           robocell::ShapeText(f.column.shape), unit);
      });
  nb::class_<PythonFeatures>(m, "CellFeatures",
                             "The named observations and commands of a scene and its robots, as "
                             "episodes record them and policies see them.",
                             nb::type_slots(features_slots))
      .def(
          "__init__",
          [](PythonFeatures* self, const Scene& scene, nb::object task,
             const std::vector<std::string>& own) {
            if (!task.is_none() && !nb::isinstance<Task>(task))
              throw nb::type_error(
                  ("CellFeatures: task must be a Task or None, got " + ShortRepr(task)).c_str());
            new (self) PythonFeatures(scene, std::move(task), own);
          },
          "scene"_a, "task"_a.none() = nb::none(), "own"_a = std::vector<std::string>(),
          nb::sig("def __init__(self, scene: Scene, task: Task | None = None, own: "
                  "collections.abc.Sequence[str] = []) -> None"),
          "`task`: whose objects and signals are observed; `own`: registered features. Robots are "
          "all of the scene.")
      .def_prop_ro(
          "observed", [](PythonFeatures& f) { return FeatureList(f.get().observed()); },
          nb::sig("def observed(self) -> list[Feature]"),
          "Features that are observed and recorded.")
      .def_prop_ro(
          "commanded", [](PythonFeatures& f) { return FeatureList(f.get().commanded()); },
          nb::sig("def commanded(self) -> list[Feature]"),
          "Features of the commands: what an action consists of.")
      .def(
          "read",
          [](PythonFeatures& f) {
            CellFeatures& features = f.get();
            std::span<const double> numbers;
            {
              const nb::gil_scoped_release release;
              numbers = features.ReadState();
            }
            return ToArrays(features.observed(), numbers);
          },
          nb::sig("def read(self) -> dict[str, numpy.typing.NDArray[numpy.float64]]"),
          "Returns the present observation: {name: numbers (n,)}.")
      .def(
          "to_action",
          [](PythonFeatures& f, const nb::dict& values) {
            return f.get().ToAction(ToNumbersByName(values));
          },
          "values"_a,
          nb::sig("def to_action(self, values: dict[str, numpy.typing.ArrayLike]) -> dict[str, "
                  "dict[str, GroupCommand]]"),
          "Converts actions by name to commands of the robots. Raises NotFoundError with the "
          "nearest names; ArgumentError is raised for two actions of one group, and for a wrong "
          "number of "
          "values.");
  m.def(
      "_recorded_features",
      [](nb::object env) {
        if (!nb::isinstance<Env>(env))
          throw nb::type_error(("expected an Env, got " + ShortRepr(env)).c_str());
        return PythonFeatures(std::move(env));
      },
      "env"_a, nb::sig("def _recorded_features(env: Env) -> CellFeatures"),
      "Returns the features of an environment's cell that its episodes record.");
  m.def("_is_by_name", &IsByName, "action"_a,
        "Returns True for an action by the names of columns in datasets. Raises ArgumentError if "
        "names of robots are among them.");
  m.def(
      "_register_feature",
      [](const std::string& name, nb::object function, std::vector<int64_t> shape,
         const std::string& unit, const std::string& frame, std::vector<std::string> names,
         const std::string& description, const std::string& role, std::vector<double> lower,
         std::vector<double> upper, nb::object code) {
        RegisterPythonFeature(name, std::move(function),
                              {.column = {.shape = std::move(shape),
                                          .units = unit,
                                          .frame = frame,
                                          .names = std::move(names),
                                          .description = description},
                               .role = ToRole(role),
                               .lower = std::move(lower),
                               .upper = std::move(upper)},
                              std::move(code));
      },
      "name"_a, "function"_a, "shape"_a, "units"_a, "frame"_a, "names"_a, "description"_a, "role"_a,
      "lower"_a, "upper"_a, "code"_a);
  m.def("feature_names", &OwnFeatures, "Returns the names of the registered features.");
}

}  // namespace robocell::python
