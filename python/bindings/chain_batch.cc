#include "chain_batch.h"

#include <fmt/format.h>
#include <nanobind/ndarray.h>

#include <cmath>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "values.h"
#include "robocell/kinematics/chain_batch.h"
#include "robocell/kinematics/manipulability.h"

namespace robocell::python {
namespace {

using namespace nb::literals;
using Sizes = std::vector<size_t>;

template <class Array>
Sizes SizesOf(const Array& array) {
  Sizes shape;
  for (size_t i = 0; i < array.ndim(); ++i) shape.push_back(array.shape(i));
  return shape;
}

std::string TextOf(const nb::object& value) { return nb::cast<std::string>(nb::str(value)); }

// Returns true for a PyKDL.JntArray, or a list whose items are not rows.
bool IsOneRow(nb::handle value) {
  if (nb::hasattr(value, "rows") && nb::hasattr(value, "columns")) return true;
  if (!nb::isinstance<nb::list>(value) && !nb::isinstance<nb::tuple>(value)) return false;
  if (nb::len(value) == 0) return false;
  const nb::object first = value[0];
  return nb::isinstance<nb::str>(first) || !nb::hasattr(first, "__len__");
}

// The numbers of one argument, one row or many.
class RowsArgument {
 public:
  RowsArgument(nb::handle value, const char* name, size_t width) : path_(name), width_(width) {
    if (IsOneRow(value)) {
      numbers_.emplace(value, path_);
      Use({numbers_->size()}, numbers_->span());
    } else if (!Borrow(value)) {
      Convert(value);
    }
  }

  std::optional<size_t> rows() const { return rows_; }
  std::span<const double> values() const { return values_; }
  const FieldPath& path() const { return path_; }

 private:
  using Contiguous = nb::ndarray<const double, nb::c_contig, nb::device::cpu>;

  bool Borrow(nb::handle value) {
    Contiguous array;
    if (!nb::try_cast(value, array, /*convert=*/false)) return false;
    keep_ = nb::borrow(value);
    Use(SizesOf(array), {array.data(), array.size()});
    return true;
  }
  void Convert(nb::handle value) {
    nb::object array;
    try {
      array = nb::module_::import_("numpy").attr("asarray")(value);
    } catch (nb::python_error&) {  // rows of different lengths
      ThrowType(path_, Expected(), value);
    }
    if (!HasRealNumbers(array)) {
      throw nb::type_error(fmt::format("{} must be {}, got {}", path_.text(), Expected(),
                                       TextOf(array.attr("dtype")))
                               .c_str());
    }
    keep_ = array.attr("astype")("float64", "order"_a = "C");
    const auto numbers = nb::cast<Contiguous>(keep_);
    Use(SizesOf(numbers), {numbers.data(), numbers.size()});
  }
  void Use(const Sizes& shape, std::span<const double> values) {
    if (shape.empty() || shape.size() > 2 || shape.back() != width_)
      ThrowValue(path_, fmt::format("must be {}, has shape {}", Expected(), ShapeText(shape)));
    if (shape.size() == 2) rows_ = shape[0];
    values_ = values;
  }
  std::string Expected() const {
    return fmt::format("numbers of shape ({},), or (B, {}) for a batch", width_, width_);
  }

  FieldPath path_;
  size_t width_;
  nb::object keep_;
  std::optional<Numbers> numbers_;
  std::optional<size_t> rows_;
  std::span<const double> values_;
};

// The arguments of one call, their common number of configurations, and the destination of the
// result.
class BatchCall {
 public:
  explicit BatchCall(const Chain& chain) : chain_(chain) {}

  std::span<const double> Joints(nb::handle value, const char* name) {
    return Take(value, name, static_cast<size_t>(chain_.n_joints()));
  }
  std::span<const double> Gravity(nb::handle value) {
    const auto gravity = Take(value, "gravity", 3);
    for (size_t k = 0; k < gravity.size(); ++k) {
      if (std::isfinite(gravity[k])) continue;
      const FieldPath path("gravity"), row(path, static_cast<Py_ssize_t>(k / 3));
      ThrowValue(FieldPath(arguments_.back().rows() ? row : path, static_cast<Py_ssize_t>(k % 3)),
                 fmt::format("must be finite, is {}", gravity[k]));
    }
    return gravity;
  }

  bool is_batch() const { return rows_.has_value(); }

  // Returns the output memory; `row` is the shape of one configuration's numbers.
  std::span<double> Written(const char* name, nb::handle out, Sizes row) {
    AddRows(&row);
    const std::span<double> numbers(NumbersIn(FieldPath(name), out, row), SizeOf(row));
    written_.push_back({name, numbers});
    return numbers;
  }

  // Runs with the output.
  nb::object Answer(Sizes row, nb::handle out, const std::function<void(std::span<double>)>& run) {
    nb::object answer;
    std::span<double> numbers;
    if (out.is_none()) {
      AddRows(&row);
      Unwritten made = NewUnwritten(nb::dtype<double>(), row);
      numbers = {static_cast<double*>(made.numbers), SizeOf(row)};
      answer = std::move(made.array);
    } else {
      numbers = Written("out", out, std::move(row));
      answer = nb::borrow(out);
    }
    const nb::gil_scoped_release release;
    run(numbers);
    return answer;
  }

 private:
  std::span<const double> Take(nb::handle value, const char* name, size_t width) {
    const RowsArgument& argument = arguments_.emplace_back(value, name, width);
    if (argument.rows()) {
      if (rows_ && *rows_ != *argument.rows())
        ThrowValue(argument.path(), fmt::format("is for {} configurations, but {} for {}",
                                                *argument.rows(), first_, *rows_));
      if (!rows_) first_ = name;
      rows_ = argument.rows();
    }
    return argument.values();
  }

  void AddRows(Sizes* row) const {
    if (rows_) row->insert(row->begin(), *rows_);
  }
  static size_t SizeOf(const Sizes& shape) {
    size_t size = 1;
    for (const size_t n : shape) size *= n;
    return size;
  }

  double* NumbersIn(const FieldPath& path, nb::handle out, const Sizes& shape) const {
    const std::string expected =
        fmt::format("a writable, C-contiguous float64 array of shape {}", ShapeText(shape));
    nb::ndarray<double, nb::c_contig, nb::device::cpu> array;
    if (!nb::try_cast(out, array, /*convert=*/false)) {
      if (!nb::hasattr(out, "dtype")) ThrowType(path, expected, out);
      ThrowValue(path, fmt::format("must be {}, got {} of shape {} that is not", expected,
                                   TextOf(out.attr("dtype")), TextOf(out.attr("shape"))));
    }
    if (SizesOf(array) != shape)
      ThrowValue(path, fmt::format("must have shape {}, has {}", ShapeText(shape),
                                   ShapeText(SizesOf(array))));
    const std::span<const double> numbers(array.data(), array.size());
    for (const RowsArgument& argument : arguments_)
      RequireApart(path, numbers, argument.path().text(), argument.values());
    for (const auto& [name, written] : written_) RequireApart(path, numbers, name, written);
    return array.data();
  }
  static void RequireApart(const FieldPath& path, std::span<const double> out,
                           const std::string& name, std::span<const double> other) {
    const bool apart = std::less_equal<>()(other.data() + other.size(), out.data()) ||
                       std::less_equal<>()(out.data() + out.size(), other.data());
    if (!apart) ThrowValue(path, "shares memory with " + name + "; give it its own");
  }

  const Chain& chain_;
  std::deque<RowsArgument> arguments_;
  std::vector<std::pair<std::string, std::span<const double>>> written_;
  std::optional<size_t> rows_;
  const char* first_ = "";
};

size_t JointsOf(const Chain& chain) { return static_cast<size_t>(chain.n_joints()); }

}  // namespace

nb::object FkOf(const Chain& chain, nb::handle q, nb::handle out) {
  BatchCall call(chain);
  const auto at = call.Joints(q, "q");
  if (!call.is_batch() && out.is_none()) return nb::cast(chain.Fk(at));
  return call.Answer({4, 4}, out, [&](std::span<double> to) { FkBatch(chain, at, to); });
}

nb::object JacobianOf(const Chain& chain, nb::handle q, nb::handle out, nb::handle tips) {
  BatchCall call(chain);
  const auto at = call.Joints(q, "q");
  std::optional<std::span<double>> to_tips;
  if (!tips.is_none()) to_tips = call.Written("tips", tips, {4, 4});
  return call.Answer({6, JointsOf(chain)}, out, [&](std::span<double> to) {
    to_tips ? JacobianBatch(chain, at, to, *to_tips) : JacobianBatch(chain, at, to);
  });
}

nb::object MassMatrixOf(const Chain& chain, nb::handle q, nb::handle out) {
  BatchCall call(chain);
  const auto at = call.Joints(q, "q");
  return call.Answer({JointsOf(chain), JointsOf(chain)}, out,
                     [&](std::span<double> to) { MassMatrixBatch(chain, at, to); });
}

nb::object GravityTorquesOf(const Chain& chain, nb::handle q, nb::handle gravity, nb::handle out) {
  BatchCall call(chain);
  const auto at = call.Joints(q, "q"), g = call.Gravity(gravity);
  return call.Answer({JointsOf(chain)}, out, [&](std::span<double> to) {
    GravityTorquesBatch(chain, at, g, to);
    for (double& torque : to) torque += 0.0;  // not -0
  });
}

nb::object CoriolisTorquesOf(const Chain& chain, nb::handle q, nb::handle qd, nb::handle out) {
  BatchCall call(chain);
  const auto at = call.Joints(q, "q"), velocity = call.Joints(qd, "qd");
  return call.Answer({JointsOf(chain)}, out, [&](std::span<double> to) {
    CoriolisTorquesBatch(chain, at, velocity, to);
    for (double& torque : to) torque += 0.0;  // not -0
  });
}

nb::object ManipulabilityOf(const Chain& chain, nb::handle q, nb::handle out) {
  BatchCall call(chain);
  const auto at = call.Joints(q, "q");
  if (!call.is_batch() && out.is_none()) return nb::float_(Manipulability(chain, at));
  return call.Answer({}, out, [&](std::span<double> to) { ManipulabilityBatch(chain, at, to); });
}

nb::object InverseDynamicsOf(const Chain& chain, nb::handle q, nb::handle qd, nb::handle qdd,
                             nb::handle gravity, nb::handle out) {
  BatchCall call(chain);
  const auto at = call.Joints(q, "q"), velocity = call.Joints(qd, "qd"),
             acceleration = call.Joints(qdd, "qdd"), g = call.Gravity(gravity);
  return call.Answer({JointsOf(chain)}, out, [&](std::span<double> to) {
    InverseDynamicsBatch(chain, at, velocity, acceleration, g, to);
  });
}

}  // namespace robocell::python
