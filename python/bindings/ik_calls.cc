#include "ik_calls.h"

#include <fmt/format.h>

#include "arrays.h"
#include "kinematics.h"
#include "signals.h"
#include "robocell/base/error.h"
#include "robocell/kinematics/ik_batch.h"
#include "robocell/kinematics/ik_solutions.h"

namespace robocell::python {
namespace {

using namespace nb::literals;

// A Pose, a Frame, or something with four rows.
bool IsOnePose(nb::handle value) {
  if (nb::isinstance<Pose>(value) || nb::hasattr(value, "M")) return true;
  if (!MayBePose(value) || nb::len(value) != 4) return false;
  return MayBePose(nb::object(value[0])) && nb::len(nb::object(value[0])) == 4;
}

// (B, 4, 4), a list of poses, or one.
std::vector<Pose> ToPoses(nb::handle targets) {
  if (const Pose* one = nullptr; nb::try_cast(targets, one) && one) return {*one};
  const bool is_list = nb::isinstance<nb::list>(targets) || nb::isinstance<nb::tuple>(targets);
  if (!is_list || nb::len(targets) == 0 || !IsOnePose(nb::object(targets[0])))
    return PosesFromMatrices(ToDoubles(targets, "targets"), "targets");
  std::vector<Pose> poses;
  for (const nb::handle item : targets) {
    try {
      poses.push_back(nb::cast<Pose>(nb::type<Pose>()(item)));
    } catch (const nb::python_error& error) {
      throw ArgumentError(fmt::format("targets[{}]: {}", poses.size(),
                                      nb::cast<std::string>(nb::str(error.value()))));
    }
  }
  return poses;
}

}  // namespace

nb::object BatchOf(const Chain& chain, nb::handle targets, std::span<const double> seeds,
                   const IkOptions& ik, int threads) {
  const std::vector<Pose> poses = ToPoses(targets);
  IkBatchResult result;
  {
    const nb::gil_scoped_release release;
    SignalPoll poll;
    const IkBatchOptions options{.ik = ik, .threads = threads, .poll = [&] { poll(); }};
    result = IkBatch(chain, poses, seeds, options);
  }
  const size_t b = static_cast<size_t>(result.size), n = static_cast<size_t>(result.n_joints);
  nb::object make = nb::module_::import_("types").attr("SimpleNamespace");
  const nb::object numpy = nb::module_::import_("numpy");
  return make(
      "q"_a = NewArray<double>(result.q, {b, n}),
      "success"_a = NewArray<uint8_t>(result.success, {b}).attr("astype")(numpy.attr("bool_")),
      "position_error"_a = NewArray<double>(result.position_error, {b}),
      "rotation_error"_a = NewArray<double>(result.rotation_error, {b}),
      "iterations"_a = NewArray<int>(result.iterations, {b}));
}

nb::object AllSolutionsOf(const Chain& chain, const Pose& target, const IkOptions& options,
                          double separation) {
  std::vector<IkResult> found;
  {
    const nb::gil_scoped_release release;
    found = IkSolutions(chain, target, options, separation);
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

}  // namespace robocell::python
