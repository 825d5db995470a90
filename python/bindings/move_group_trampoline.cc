#include "move_group_trampoline.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "python_owner.h"
#include "returned.h"
#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"

namespace robocell::python {
namespace {

nb::object Array(std::span<const double> values) {
  return NewArray<double>(values, {values.size()});
}

// Returns true for the method of MoveGroup itself, which would call the group again.
bool IsInherited(nb::handle method, const char* name) {
  const nb::handle base = nb::type<MoveGroup>();
  if (!nb::hasattr(base, name) || !nb::hasattr(method, "__self__")) return false;
  return nb::object(method.attr("__self__").type().attr(name)).is(nb::object(base.attr(name)));
}

// Returns the bound method. Throws Error with the class that does not define it.
nb::object Method(nb::handle self, const char* name) {
  const nb::object method = nb::getattr(self, name, nb::none());
  if (!method.is_none() && !IsInherited(method, name)) return method;
  throw Error("a group written in Python must define " + std::string(name) + "(); " +
              ClassName(self) + " does not");
}

// Reads the numbers that a method returned. A wrong shape is an error, even with the right count;
// an empty array is accepted in any shape.
std::vector<double> NumbersOf(nb::handle self, const char* name, nb::handle numbers,
                              const std::vector<size_t>& expected) {
  std::vector<size_t> shape;
  std::vector<double> values = ToDoubles(numbers, name, shape);
  const bool none =
      values.empty() && std::find(expected.begin(), expected.end(), 0U) != expected.end();
  if (shape == expected || none) return values;
  const std::string place = ClassName(self) + "." + name;
  if (shape.size() == 1 && expected.size() == 1) {
    throw ArgumentError(fmt::format("{}: expected {}, got {}", place,
                                    Counted(static_cast<int64_t>(expected[0]), "value"), shape[0]));
  }
  throw ArgumentError(fmt::format("{}: expected an array of shape {}, got {}", place,
                                  ShapeText(expected), ShapeText(shape)));
}

void CopyNumbers(nb::handle self, const char* name, nb::handle numbers, std::span<double> out) {
  const std::vector<double> values = NumbersOf(self, name, numbers, {out.size()});
  std::copy(values.begin(), values.end(), out.begin());
}

double Finite(nb::handle self, const char* name, double value) {
  if (std::isfinite(value)) return value;
  throw ArgumentError(
      fmt::format("{}.{}() must return a finite number, got {}", ClassName(self), name, value));
}

// Returns the result of the method for these arguments.
template <class T, class... Args>
T Ask(const WrittenInPython& group, const char* name, const Args&... args) {
  const nb::gil_scoped_acquire gil;
  const nb::object self = group.object();
  return Returned<T>(self, name, Method(self, name)(args...));
}

// The same for numbers that C++ uses.
template <class... Args>
double AskNumber(const WrittenInPython& group, const char* name, const Args&... args) {
  const nb::gil_scoped_acquire gil;
  const nb::object self = group.object();
  return Finite(self, name, Returned<double>(self, name, Method(self, name)(args...)));
}

// The group that a robot keeps.
template <class Calls>
class KeptGroup : public Calls {
 public:
  explicit KeptGroup(nb::object object) : object_(std::move(object)) {}
  PyObject* python_object() const override { return object_.target(); }

 private:
  Held object_;
};

}  // namespace

nb::object WrittenInPython::object() const {
  if (PyObject* object = python_object()) return nb::borrow(object);
  throw ClosedError("a move group written in Python is gone: Python is shutting down");
}

namespace group_call {

void Get(const WrittenInPython& group, const char* method, std::span<double> out) {
  const nb::gil_scoped_acquire gil;
  const nb::object self = group.object();
  CopyNumbers(self, method, Method(self, method)(), out);
}

void Set(const WrittenInPython& group, const char* method, std::span<const double> values) {
  const nb::gil_scoped_acquire gil;
  Method(group.object(), method)(Array(values));
}

int Count(const WrittenInPython& group, const char* method) {
  const nb::gil_scoped_acquire gil;
  return static_cast<int>(ToDoubles(Method(group.object(), method)(), method).size());
}

double Number(const WrittenInPython& group, const char* method) { return AskNumber(group, method); }

std::vector<Interval> Intervals(const WrittenInPython& group, const char* method, int count) {
  const nb::gil_scoped_acquire gil;
  const nb::object self = group.object();
  const std::vector<double> flat =
      NumbersOf(self, method, Method(self, method)(), {static_cast<size_t>(count), 2});
  std::vector<Interval> intervals;
  for (size_t i = 0; i < flat.size(); i += 2) intervals.push_back({flat[i], flat[i + 1]});
  return intervals;
}

Pose Frame(const WrittenInPython& group, const char* method) { return Ask<Pose>(group, method); }

std::string Text(const WrittenInPython& group, const char* method) {
  return Ask<std::string>(group, method);
}

std::vector<std::string> Texts(const WrittenInPython& group, const char* method) {
  return Ask<std::vector<std::string>>(group, method);
}

MoveGroupKind Kind(const WrittenInPython& group, MoveGroupKind otherwise) {
  const nb::gil_scoped_acquire gil;
  const nb::object self = group.object();
  if (!nb::hasattr(self, "get_kind")) return otherwise;
  const nb::object returned = Method(self, "get_kind")();
  MoveGroupKind kind{};
  if (nb::try_cast(returned, kind)) return kind;
  if (!nb::isinstance<nb::str>(returned))
    ThrowReturned(self, "get_kind", "a MoveGroupKind or its name", returned);
  const auto name = nb::cast<std::string>(returned);
  std::vector<std::string> names;
  for (const auto& [value, text] : EnumNames<MoveGroupKind>::kNames) {
    if (name == text) return value;
    names.emplace_back(text);
  }
  throw NotFoundError(NoSuchName(ClassName(self) + ".get_kind", "kind", name, names));
}

void CtrlForJointPos(const WrittenInPython& group, std::span<const double> q,
                     std::span<double> ctrl) {
  const nb::gil_scoped_acquire gil;
  const nb::object self = group.object();
  const char* name = "ctrl_for_joint_pos";
  CopyNumbers(self, name, Method(self, name)(Array(q)), ctrl);
}

void Integrate(const WrittenInPython& group, std::span<double> q, std::span<const double> v) {
  const nb::gil_scoped_acquire gil;
  const nb::object self = group.object();
  CopyNumbers(self, "integrate", Method(self, "integrate")(Array(q), Array(v)), q);
}

void Jacobian(const WrittenInPython& group,
              Eigen::Ref<Eigen::Matrix<double, 6, Eigen::Dynamic>> j) {
  const nb::gil_scoped_acquire gil;
  const nb::object self = group.object();
  const char* name = "get_jacobian";
  const std::vector<double> flat =
      NumbersOf(self, name, Method(self, name)(), {6, static_cast<size_t>(j.cols())});
  for (int r = 0; r < 6; ++r) {
    for (int c = 0; c < j.cols(); ++c) j(r, c) = flat[static_cast<size_t>(r * j.cols() + c)];
  }
}

}  // namespace group_call

void GripperGroupCalls::SetOpening(double opening) {
  const nb::gil_scoped_acquire gil;
  Method(object(), "set_opening")(opening);
}

double GripperGroupCalls::ctrl_for_opening(double opening) const {
  return AskNumber(*this, "ctrl_for_opening", opening);
}

Interval GripperGroupCalls::inter_finger_dist_range() const {
  std::vector<double> range(2);
  Get("get_inter_finger_dist_range", range);
  return {range[0], range[1]};
}

bool GripperGroupCalls::is_open() const { return Ask<bool>(*this, "get_is_open"); }

bool GripperGroupCalls::is_grasping(const std::string& body) const {
  return Ask<bool>(*this, "get_is_grasping", body);
}

void BaseGroupCalls::SetPose(const Pose& pose_in_world) {
  const nb::gil_scoped_acquire gil;
  Method(object(), "set_pose")(pose_in_world);
}

bool BaseGroupCalls::is_mobile() const { return Ask<bool>(*this, "get_is_mobile"); }

std::shared_ptr<MoveGroup> KeepGroup(nb::object object) {
  RequireInitialised(object);
  MoveGroup* group = nb::cast<MoveGroup*>(object);
  if (!dynamic_cast<WrittenInPython*>(group)) return Shared<MoveGroup>(std::move(object));
  if (dynamic_cast<GripperGroup*>(group))
    return std::make_shared<KeptGroup<GripperGroupCalls>>(std::move(object));
  if (dynamic_cast<BaseGroup*>(group))
    return std::make_shared<KeptGroup<BaseGroupCalls>>(std::move(object));
  return std::make_shared<KeptGroup<MoveGroupCalls>>(std::move(object));
}

}  // namespace robocell::python
