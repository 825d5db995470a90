#include "ik_calls.h"

#include <fmt/ranges.h>

#include <optional>

#include "arrays.h"
#include "ik_objectives.h"
#include "kinematics.h"
#include "signals.h"
#include "values.h"
#include "robocell/base/error.h"
#include "robocell/kinematics/ik_batch.h"
#include "robocell/kinematics/ik_solutions.h"
#include "robocell/kinematics/reach_map.h"

namespace robocell::python {
namespace {

using namespace nb::literals;

[[noreturn]] void RefuseShape(const char* name, const std::string& expected,
                              const std::vector<size_t>& shape) {
  throw ArgumentError(fmt::format("{} must be {}, has shape ({}{})", name, expected,
                                  fmt::join(shape, ", "), shape.size() == 1 ? "," : ""));
}

// Returns the joint values, or none if None was given.
JointVector JointsOf(nb::handle values, const char* name) {
  if (values.is_none()) return {};
  const FieldPath path(name);
  return ToJointVector(Numbers(values, path), name);
}

nb::object Three(const Eigen::Vector3d& v) {
  return NewArray<double>(std::span<const double>(v.data(), 3), {3});
}

Eigen::Vector3d ToThree(nb::handle value, const char* name) {
  const FieldPath path(name);
  const Numbers three(value, path, 3);
  return {three[0], three[1], three[2]};
}

nb::handle Namespace() {
  static PyObject* type = nullptr;  // kept for ever, with the GIL
  if (!type)
    type = nb::object(nb::module_::import_("types").attr("SimpleNamespace")).release().ptr();
  return type;
}

// Returns true if the value is one pose: a Pose, a Frame, or something with four rows.
bool IsOnePose(nb::handle value) {
  if (nb::isinstance<Pose>(value) || nb::hasattr(value, "M")) return true;
  if (!MayBePose(value) || nb::len(value) != 4) return false;
  return MayBePose(nb::object(value[0])) && nb::len(nb::object(value[0])) == 4;
}

// The targets, and the arrays that they refer to.
struct Targets {
  std::optional<Doubles> array{};
  std::vector<double> list{};
  IkTargets all{};
};

// Appends the 4x4 numbers of an item of a list. Matrices are not changed, so that a list of
// matrices gives the same results as an array of them.
void AppendMatrix(nb::handle item, std::vector<double>* numbers) {
  const auto pose = nb::cast<Pose>(nb::type<Pose>()(item));
  if (!nb::isinstance<Pose>(item) && !nb::hasattr(item, "M")) {
    const Doubles given(item, "targets");
    if (given.span().size() == 16) {
      numbers->insert(numbers->end(), given.span().begin(), given.span().end());
      return;
    }
  }
  const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> matrix = pose.matrix();
  numbers->insert(numbers->end(), matrix.data(), matrix.data() + matrix.size());
}

// Converts a list of poses.
std::vector<double> MatricesOf(nb::handle list) {
  std::vector<double> numbers;
  for (const nb::handle item : list) {
    const size_t row = numbers.size() / 16;
    if (item.is_none())  // Pose would turn it into the identity
      throw ArgumentError(fmt::format("targets[{}] must be a pose, got None", row));
    try {
      AppendMatrix(item, &numbers);
    } catch (const nb::python_error& error) {
      throw ArgumentError(
          fmt::format("targets[{}]: {}", row, nb::cast<std::string>(nb::str(error.value()))));
    }
  }
  return numbers;
}

// Converts an array (B, 4, 4), a list of poses, or one pose.
Targets ToTargets(nb::handle targets) {
  Targets converted;
  if (nb::isinstance<Pose>(targets)) {
    AppendMatrix(targets, &converted.list);
    converted.all = IkTargets::FromMatrices(converted.list);
    return converted;
  }
  const bool is_list = nb::isinstance<nb::list>(targets) || nb::isinstance<nb::tuple>(targets);
  if (is_list && nb::len(targets) > 0 && IsOnePose(nb::object(targets[0]))) {
    converted.list = MatricesOf(targets);
    converted.all = IkTargets::FromMatrices(converted.list);
    return converted;
  }
  const Doubles& matrices = converted.array.emplace(targets, "targets");
  const std::vector<size_t> shape = matrices.shape();
  const bool is_one = shape == std::vector<size_t>{4, 4};
  const bool are_many = shape.size() == 3 && shape[1] == 4 && shape[2] == 4;
  if (!is_one && !are_many && !matrices.span().empty())
    RefuseShape("targets", "4x4 matrices (B, 4, 4), or a list of poses", shape);
  converted.all = IkTargets::FromMatrices(matrices.span());
  return converted;
}

}  // namespace

nb::object BatchOf(const Chain& chain, nb::handle targets, std::span<const double> seeds,
                   const IkOptions& ik, int threads) {
  const Targets converted = ToTargets(targets);
  IkBatchResult result;
  {
    const nb::gil_scoped_release release;
    SignalPoll poll;
    const IkBatchOptions options{.ik = ik, .threads = threads, .poll = [&] { poll(); }};
    result = IkBatch(chain, converted.all, seeds, options);
  }
  const size_t b = static_cast<size_t>(result.size), n = static_cast<size_t>(result.n_joints);
  return Namespace()("q"_a = NewArray(std::move(result.q), {b, n}),
                     "success"_a = NewArray<uint8_t, bool>(std::move(result.success), {b}),
                     "position_error"_a = NewArray(std::move(result.position_error), {b}),
                     "rotation_error"_a = NewArray(std::move(result.rotation_error), {b}),
                     "iterations"_a = NewArray(std::move(result.iterations), {b}));
}

std::vector<double> SeedsOf(const Chain& chain, nb::handle seeds) {
  if (seeds.is_none()) return {};
  std::vector<size_t> shape;
  std::vector<double> values = ToDoubles(seeds, "seeds", shape);
  const auto n = static_cast<size_t>(chain.n_joints());
  if (shape.size() > 2 || shape.back() != n)
    RefuseShape("seeds", fmt::format("({},), or (B, {}) for a seed each", n, n), shape);
  return values;
}

nb::object AllSolutionsOf(const Chain& chain, const Pose& target, const IkOptions& options,
                          double separation) {
  std::vector<IkResult> found;
  {
    const nb::gil_scoped_release release;
    SignalPoll poll;
    found = IkSolutions(chain, target, options, separation, [&] { poll(); });
  }
  std::vector<double> rows;
  for (const IkResult& one : found) rows.insert(rows.end(), one.q.begin(), one.q.end());
  return NewArray<double>(rows, {found.size(), static_cast<size_t>(chain.n_joints())});
}

int RestartsOf(int starts) {
  if (starts < 1)
    throw ArgumentError(
        fmt::format("inverse kinematics: starts is {}; it must be 1 or more", starts));
  return starts - 1;
}

nb::object TwistOf(const Chain& chain, nb::handle q, nb::handle twist, nb::handle frame,
                   double seconds, nb::handle max_speed, nb::handle posture, double posture_rate,
                   const TwistPlace& place) {
  const FieldPath path("twist"), q_path("q");
  const Numbers six(twist, path, 6);
  const DifferentialIkOptions options{.frame = ToTwistFrame(frame),
                                      .base_in_world = place.base_in_world,
                                      .seconds = seconds,
                                      .max_speed = JointsOf(max_speed, "max_speed"),
                                      .posture = JointsOf(posture, "posture"),
                                      .posture_rate = posture_rate,
                                      .locked = place.locked};
  const DifferentialIkResult found = DifferentialIk(
      chain, Numbers(q, q_path), {{six[0], six[1], six[2]}, {six[3], six[4], six[5]}}, options);
  const Eigen::Matrix<double, 6, 1> moved = found.twist.vector();
  return Namespace()(
      "velocity"_a = NewArray<double>(found.velocity, {static_cast<size_t>(found.velocity.size())}),
      "twist"_a = NewArray<double>(std::span<const double>(moved.data(), 6), {6}),
      "slower"_a = found.slower);
}

nb::object ReachMapOf(const Chain& chain, nb::handle lower, nb::handle upper, double cell,
                      int rotations, double tolerance, int max_restarts, int threads,
                      bool position_only, nb::handle axis) {
  const ReachGrid grid{
      .lower = ToThree(lower, "lower"), .upper = ToThree(upper, "upper"), .cell = cell};
  const std::optional<Eigen::Vector3d> direction = ToAxis(axis);
  ReachMap map;
  {
    const nb::gil_scoped_release release;
    SignalPoll poll;
    map = MapReach(chain, grid,
                   {.rotations = rotations,
                    .position_only = position_only,
                    .axis = direction,
                    .tolerance = tolerance,
                    .max_restarts = max_restarts,
                    .threads = threads,
                    .poll = [&] { poll(); }});
  }
  std::vector<double> centres[3];
  std::vector<size_t> shape;
  for (int axis = 0; axis < 3; ++axis) {
    shape.push_back(static_cast<size_t>(map.cells[axis]));
    for (int i = 0; i < map.cells[axis]; ++i)
      centres[axis].push_back(map.first[axis] + i * map.cell);
  }
  return Namespace()("fraction"_a = NewArray<float>(map.fraction, shape),
                     "manipulability"_a = NewArray<float>(map.manipulability, shape),
                     "x"_a = NewArray(centres[0]), "y"_a = NewArray(centres[1]),
                     "z"_a = NewArray(centres[2]), "cell"_a = map.cell,
                     "rotations"_a = map.rotations);
}

nb::object ReachBoxOf(const Chain& chain) {
  const ReachGrid grid = ReachGrid::Around(chain);
  return nb::make_tuple(Three(grid.lower), Three(grid.upper));
}

}  // namespace robocell::python
