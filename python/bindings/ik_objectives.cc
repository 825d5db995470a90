#include "ik_objectives.h"

#include <fmt/format.h>

#include <algorithm>

#include "arrays.h"
#include "scene_cycles.h"
#include "values.h"
#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/robot/collision_filter.h"

namespace robocell::python {
namespace {

using namespace nb::literals;

constexpr std::array kPreferences = {std::pair{IkPrefer::kFirst, "first"},
                                     std::pair{IkPrefer::kSeed, "seed"},
                                     std::pair{IkPrefer::kAwayFromLimits, "limits"},
                                     std::pair{IkPrefer::kManipulability, "manipulability"}};

void ApplyWeights(nb::handle value, const char* name, std::array<double, 3>* weights) {
  if (!value || value.is_none()) return;
  const FieldPath path(name);
  const Numbers three(value, path, 3);
  std::copy(three.span().begin(), three.span().end(), weights->begin());
}

int VisitFilter(const CollisionFilter& filter, visitproc visit, void* arg) {
  const std::optional<Scene> scene = filter.scene_of_sole_handle();
  return scene ? VisitScene(*scene, visit, arg) : 0;
}

void ApplyPreference(nb::handle value, IkOptions* options) {
  if (!value || value.is_none()) return;
  const FieldPath path("prefer");
  if (!IsText(value)) {
    options->prefer = IkPrefer::kPosture;
    options->posture = JointVector(Numbers(value, path).span());
    return;
  }
  const std::string text = ToText(value, path);
  std::vector<std::string> names;
  for (const auto& [prefer, name] : kPreferences) {
    names.emplace_back(name);
    if (text != name) continue;
    options->prefer = prefer;
    return;
  }
  ThrowValue(path, "must be one of " + ListNames(names) + " or a posture (n,), got '" + text +
                       "'." + DidYouMean(text, names));
}

// Converts the result of a filter to booleans. Numpy converts anything to booleans (indices of
// rows, clearances, names), so other types are rejected.
nb::object MaskFrom(const nb::object& answer, size_t rows) {
  const nb::object numpy = nb::module_::import_("numpy");
  const auto refuse = [&](const std::string& got) {
    throw ArgumentError(
        fmt::format("filter must return ({},) booleans, one for each row that it was given, got {}",
                    rows, got));
  };
  nb::object mask;
  try {
    mask = numpy.attr("asarray")(answer);
  } catch (nb::python_error&) {  // rows of different lengths
    refuse(TypeName(answer));
  }
  const nb::object shape = mask.attr("shape");
  if (nb::len(shape) != 1 || nb::cast<size_t>(shape[0]) != rows)
    refuse("shape " + nb::cast<std::string>(nb::str(shape)));
  const nb::object dtype = mask.attr("dtype");
  const auto kind = nb::cast<std::string>(dtype.attr("kind"));
  const bool numbers = kind == "f" || kind == "i" || kind == "u";
  if (kind != "b" && !numbers) refuse("dtype " + nb::cast<std::string>(nb::str(dtype)));
  const nb::object truth = mask.attr("astype")(numpy.attr("bool_"));
  if (numbers && !nb::cast<bool>(numpy.attr("array_equal")(truth, mask))) {
    refuse("numbers (dtype " + nb::cast<std::string>(nb::str(dtype)) + ") that are not all 0 or 1");
  }
  return truth;
}

// The filter takes rows and returns one boolean for each.
void CallFilter(nb::handle filter, std::span<const double> q, int count, std::span<uint8_t> keep) {
  const nb::gil_scoped_acquire gil;
  const size_t rows = static_cast<size_t>(count);
  const nb::object mask = MaskFrom(filter(NewArray<double>(q, {rows, q.size() / rows})), rows);
  const nb::object bytes = mask.attr("tobytes")();
  const char* truth = PyBytes_AsString(bytes.ptr());
  for (size_t k = 0; k < rows; ++k) keep[k] = truth[k] != 0;
}

void ApplyFilter(nb::handle value, IkOptions* options) {
  if (!value || value.is_none()) return;
  if (const CollisionFilter* ready = nullptr; nb::try_cast(value, ready) && ready) {
    options->filter = *ready;
    return;
  }
  if (!PyCallable_Check(value.ptr()))
    ThrowType(FieldPath("filter"), "a CollisionFilter or a function of joint values (k, n)", value);
  // A plain handle: copies of the options need no GIL.
  options->filter = [value](std::span<const double> q, int count, std::span<uint8_t> keep) {
    CallFilter(value, q, count, keep);
  };
}

nb::object MaskOf(CollisionFilter& filter, nb::handle q) {
  std::vector<size_t> shape;
  const std::vector<double> rows = ToDoubles(q, "q", shape);
  if (shape.size() != 2 || shape[1] != static_cast<size_t>(filter.n_joints())) {
    throw ArgumentError(
        fmt::format("q must be (k, {}), got {}", filter.n_joints(),
                    shape.size() == 1 ? fmt::format("({},)", shape[0]) : "another shape"));
  }
  std::vector<uint8_t> keep(shape[0]);
  {
    const nb::gil_scoped_release release;
    filter(rows, static_cast<int>(shape[0]), keep);
  }
  const nb::object numpy = nb::module_::import_("numpy");
  return NewArray<uint8_t>(keep, {shape[0]}).attr("astype")(numpy.attr("bool_"));
}

}  // namespace

std::optional<Eigen::Vector3d> ToAxis(nb::handle axis) {
  if (!axis || axis.is_none()) return std::nullopt;
  const FieldPath path("axis");
  if (IsText(axis)) {
    const std::string name = ToText(axis, path);
    const size_t place = std::string("xyz").find(name);
    if (name.size() == 1 && place != std::string::npos)
      return Eigen::Vector3d::Unit(static_cast<Eigen::Index>(place));
    throw ArgumentError(fmt::format(
        "axis must be \"x\", \"y\", \"z\" or a direction such as [0, 0, -1], got \"{}\"", name));
  }
  const Numbers three(axis, path, 3);
  return Eigen::Vector3d(three[0], three[1], three[2]);
}

void IkObjectives::Apply(IkOptions* options) const {
  ApplyWeights(position_weights, "position_weights", &options->position_weights);
  ApplyWeights(rotation_weights, "rotation_weights", &options->rotation_weights);
  options->axis = ToAxis(axis);
  options->cone = cone;
  ApplyPreference(prefer, options);
  ApplyFilter(filter, options);
}

JointVector ToJointVector(std::span<const double> values, const char* name) {
  if (values.size() > kMaxChainJoints) {
    throw ArgumentError(
        fmt::format("{}: expected one value for each joint, of which a chain has "
                    "at most {}, got {}",
                    name, kMaxChainJoints, values.size()));
  }
  return JointVector(values);
}

JointVector IkSeed(nb::handle seed, const Chain& chain) {
  if (seed.is_none()) return {};
  const auto there = RowOf(seed);
  const JointVector read =
      there ? ToJointVector(*there, "seed") : ToJointVector(ToRow(seed, "seed"), "seed");
  if (read.empty()) {
    throw ArgumentError(
        fmt::format("inverse kinematics of {}: seed: expected {} joint values, got 0; without one "
                    "the seed is None",
                    chain.description(), chain.n_joints()));
  }
  return read;
}

void BindCollisionFilter(nb::module_& m) {
  nb::class_<CollisionFilter>(
      m, "CollisionFilter",
      "Finds collision-free configurations of an arm with the engine's collision "
      "detection.\n\nPass it as `filter` of inverse kinematics, or call it with q (k, n) for a "
      "mask (k,). It uses a copy of the scene's state from when the filter was made or last "
      "updated with update(). Threads that share a filter take turns. It raises RuntimeError after "
      "objects were added to the scene or removed: make the filter again.",
      nb::type_slots(kHandleSlots<CollisionFilter, &VisitFilter>))
      .def(
          "__init__",
          [](CollisionFilter* self, const Robot& robot, double clearance,
             const std::vector<std::string>& ignored) {
            new (self) CollisionFilter(robot, {.clearance = clearance, .ignored = ignored});
          },
          "robot"_a, "clearance"_a = 0.0, "ignored"_a = std::vector<std::string>{},
          "clearance: least distance to everything that is not the robot, metres. ignored: bodies "
          "that the robot may touch, with everything attached to them, by full name.")
      .def("update", &CollisionFilter::Update, nb::call_guard<nb::gil_scoped_release>(),
           "Copies the scene's present state.")
      .def("__call__", &MaskOf, "q"_a,
           nb::sig("def __call__(self, q: numpy.typing.ArrayLike) -> "
                   "numpy.typing.NDArray[numpy.bool_]"),
           "Takes q (k, n) in chain order and returns (k,), true for collision-free "
           "configurations.");
}

}  // namespace robocell::python
