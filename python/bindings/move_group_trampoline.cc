#include "move_group_trampoline.h"

#include <algorithm>

#include "arrays.h"
#include "robocell/base/error.h"

namespace robocell::python {
namespace {

// "MyGroup.get_joint_pos: expected 7 values, got 3".
void Copy(nb::handle self, const char* method, const std::vector<double>& values,
          std::span<double> out) {
  if (values.size() != out.size()) {
    throw ArgumentError(nb::cast<std::string>(nb::str(self.type().attr("__name__"))) + "." +
                        method + ": expected " + std::to_string(out.size()) + " values, got " +
                        std::to_string(values.size()));
  }
  std::copy(values.begin(), values.end(), out.begin());
}

}  // namespace

nb::object PyMoveGroup::Call(const char* method) const {
  nb::handle self = nb_trampoline.base();
  if (!nb::hasattr(self, method)) {
    throw Error("a MoveGroup written in Python must define " + std::string(method) + "(); " +
                nb::cast<std::string>(nb::str(self.type().attr("__name__"))) + " does not");
  }
  return self.attr(method);
}

void PyMoveGroup::Get(const char* method, std::span<double> out) const {
  nb::gil_scoped_acquire gil;
  Copy(nb_trampoline.base(), method, ToDoubles(Call(method)(), method), out);
}

void PyMoveGroup::Set(const char* method, std::span<const double> values) {
  nb::gil_scoped_acquire gil;
  Call(method)(NewArray<double>(values, {values.size()}));
}

std::vector<Interval> PyMoveGroup::Intervals(const char* method) const {
  nb::gil_scoped_acquire gil;
  const std::vector<double> flat = ToDoubles(Call(method)(), method);
  std::vector<Interval> intervals;
  for (size_t i = 0; i + 1 < flat.size(); i += 2) intervals.push_back({flat[i], flat[i + 1]});
  return intervals;
}

Pose PyMoveGroup::Frame(const char* method) const {
  nb::gil_scoped_acquire gil;
  return nb::cast<Pose>(Call(method)());
}

const std::string& PyMoveGroup::name() const {
  nb::gil_scoped_acquire gil;
  return name_ = nb::cast<std::string>(Call("get_name")());
}

MoveGroupKind PyMoveGroup::kind() const { return MoveGroupKind::kGeneric; }

int PyMoveGroup::nq() const {
  nb::gil_scoped_acquire gil;
  return static_cast<int>(ToDoubles(Call("get_joint_pos")(), "get_joint_pos").size());
}

int PyMoveGroup::nv() const {
  nb::gil_scoped_acquire gil;
  return static_cast<int>(ToDoubles(Call("get_joint_vel")(), "get_joint_vel").size());
}

int PyMoveGroup::nu() const {
  nb::gil_scoped_acquire gil;
  return static_cast<int>(ToDoubles(Call("get_ctrl")(), "get_ctrl").size());
}

const std::vector<std::string>& PyMoveGroup::joint_names() const {
  nb::gil_scoped_acquire gil;
  return joint_names_ = nb::cast<std::vector<std::string>>(Call("get_joint_names")());
}

const std::vector<std::string>& PyMoveGroup::actuator_names() const {
  nb::gil_scoped_acquire gil;
  return actuator_names_ = nb::cast<std::vector<std::string>>(Call("get_actuator_names")());
}

void PyMoveGroup::CtrlForJointPos(std::span<const double> q, std::span<double> ctrl) const {
  nb::gil_scoped_acquire gil;
  const char* method = "ctrl_for_joint_pos";
  Copy(nb_trampoline.base(), method,
       ToDoubles(Call(method)(NewArray<double>(q, {q.size()})), method), ctrl);
}

void PyMoveGroup::Integrate(std::span<double> q, std::span<const double> v) const {
  nb::gil_scoped_acquire gil;
  const char* method = "integrate";
  const nb::object moved =
      Call(method)(NewArray<double>(q, {q.size()}), NewArray<double>(v, {v.size()}));
  Copy(nb_trampoline.base(), method, ToDoubles(moved, method), q);
}

void PyMoveGroup::Jacobian(Eigen::Ref<Eigen::Matrix<double, 6, Eigen::Dynamic>> out) const {
  nb::gil_scoped_acquire gil;
  std::vector<double> flat(6 * static_cast<size_t>(out.cols()));
  Copy(nb_trampoline.base(), "get_jacobian", ToDoubles(Call("get_jacobian")(), "get_jacobian"),
       flat);
  for (int r = 0; r < 6; ++r) {
    for (int c = 0; c < out.cols(); ++c) out(r, c) = flat[static_cast<size_t>(r * out.cols() + c)];
  }
}

}  // namespace robocell::python
