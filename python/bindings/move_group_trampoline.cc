#include "move_group_trampoline.h"

#include <algorithm>

#include "returned.h"
#include "robocell/base/error.h"
#include "robocell/base/names.h"

namespace robocell::python {
namespace {

template <class T>
T Ask(nb::handle self, const char* method) {
  const nb::gil_scoped_acquire gil;
  return Returned<T>(self, method, group_call::Method(self, method)());
}

nb::object Array(std::span<const double> values) {
  return NewArray<double>(values, {values.size()});
}

}  // namespace

namespace group_call {

bool Has(nb::handle self, const char* name) {
  const nb::gil_scoped_acquire gil;
  return nb::hasattr(self, name);
}

nb::object Method(nb::handle self, const char* name) {
  if (nb::hasattr(self, name)) return self.attr(name);
  throw Error("a group written in Python must define " + std::string(name) + "(); " +
              ClassName(self) + " does not");
}

void Copy(nb::handle self, const char* name, nb::handle numbers, std::span<double> out) {
  const std::vector<double> values = ToDoubles(numbers, name);
  if (values.size() != out.size()) {
    throw ArgumentError(ClassName(self) + "." + name + ": expected " + std::to_string(out.size()) +
                        " values, got " + std::to_string(values.size()));
  }
  std::copy(values.begin(), values.end(), out.begin());
}

void Get(nb::handle self, const char* name, std::span<double> out) {
  const nb::gil_scoped_acquire gil;
  Copy(self, name, Method(self, name)(), out);
}

void Set(nb::handle self, const char* name, std::span<const double> values) {
  const nb::gil_scoped_acquire gil;
  Method(self, name)(Array(values));
}

int Count(nb::handle self, const char* name) {
  const nb::gil_scoped_acquire gil;
  return static_cast<int>(ToDoubles(Method(self, name)(), name).size());
}

double Number(nb::handle self, const char* name) { return Ask<double>(self, name); }

std::vector<Interval> Intervals(nb::handle self, const char* name) {
  const nb::gil_scoped_acquire gil;
  const std::vector<double> flat = ToDoubles(Method(self, name)(), name);
  std::vector<Interval> intervals;
  for (size_t i = 0; i + 1 < flat.size(); i += 2) intervals.push_back({flat[i], flat[i + 1]});
  return intervals;
}

Pose Frame(nb::handle self, const char* name) { return Ask<Pose>(self, name); }

std::string Text(nb::handle self, const char* name) { return Ask<std::string>(self, name); }

std::vector<std::string> Texts(nb::handle self, const char* name) {
  return Ask<std::vector<std::string>>(self, name);
}

MoveGroupKind Kind(nb::handle self, MoveGroupKind otherwise) {
  const nb::gil_scoped_acquire gil;
  if (!Has(self, "get_kind")) return otherwise;
  const nb::object said = Method(self, "get_kind")();
  MoveGroupKind kind{};
  if (nb::try_cast(said, kind)) return kind;
  if (!nb::isinstance<nb::str>(said))
    ThrowReturned(self, "get_kind", "a MoveGroupKind or its name", said);
  const auto name = nb::cast<std::string>(said);
  std::vector<std::string> names;
  for (const auto& [value, text] : EnumNames<MoveGroupKind>::kNames) {
    if (name == text) return value;
    names.emplace_back(text);
  }
  throw NotFoundError(NoSuchName(ClassName(self) + ".get_kind", "kind", name, names));
}

void CtrlForJointPos(nb::handle self, std::span<const double> q, std::span<double> ctrl) {
  const nb::gil_scoped_acquire gil;
  const char* name = "ctrl_for_joint_pos";
  Copy(self, name, Method(self, name)(Array(q)), ctrl);
}

void Integrate(nb::handle self, std::span<double> q, std::span<const double> v) {
  const nb::gil_scoped_acquire gil;
  Copy(self, "integrate", Method(self, "integrate")(Array(q), Array(v)), q);
}

void Jacobian(nb::handle self, Eigen::Ref<Eigen::Matrix<double, 6, Eigen::Dynamic>> out) {
  std::vector<double> flat(6 * static_cast<size_t>(out.cols()));
  Get(self, "get_jacobian", flat);
  for (int r = 0; r < 6; ++r) {
    for (int c = 0; c < out.cols(); ++c) out(r, c) = flat[static_cast<size_t>(r * out.cols() + c)];
  }
}

}  // namespace group_call

void PyGripperGroup::SetOpening(double opening) {
  const nb::gil_scoped_acquire gil;
  group_call::Method(self(), "set_opening")(opening);
}

double PyGripperGroup::ctrl_for_opening(double opening) const {
  const nb::gil_scoped_acquire gil;
  const char* name = "ctrl_for_opening";
  return Returned<double>(self(), name, group_call::Method(self(), name)(opening));
}

Interval PyGripperGroup::inter_finger_dist_range() const {
  std::vector<double> range(2);
  Get("get_inter_finger_dist_range", range);
  return {range[0], range[1]};
}

bool PyGripperGroup::is_open() const { return Ask<bool>(self(), "get_is_open"); }

bool PyGripperGroup::is_grasping(const std::string& body) const {
  const nb::gil_scoped_acquire gil;
  const char* name = "get_is_grasping";
  return Returned<bool>(self(), name, group_call::Method(self(), name)(body));
}

void PyBaseGroup::SetPose(const Pose& pose_in_world) {
  const nb::gil_scoped_acquire gil;
  group_call::Method(self(), "set_pose")(pose_in_world);
}

bool PyBaseGroup::is_mobile() const { return Ask<bool>(self(), "get_is_mobile"); }

}  // namespace robocell::python
