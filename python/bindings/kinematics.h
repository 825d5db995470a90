// What `robot.kinematics` is in Python: the robot's kinematic functions under one name; and what
// kinematics takes from and gives to PyKDL.
#pragma once

#include "bindings.h"
#include "robocell/math/twist.h"
#include "robocell/robot/robot.h"

namespace robocell::python {

struct Kinematics {
  Robot robot;
};

// An argument that is a Pose or a PyKDL.Frame, which has no type that annotations could name.
struct PoseOrFrame {
  Pose pose;
};

// Chains on their own. Needs IkResult to be bound.
void BindChain(nb::module_& m);

// A PyKDL.Chain; ImportError with the install line when PyKDL is missing.
nb::object ToPyKdl(const Chain& chain);
// From a PyKDL.Chain, with limits as ChainFromSegments takes them. TypeError for anything else.
Chain FromPyKdl(nb::handle chain, std::span<const std::array<double, 2>> limits);
// A PyKDL.Wrench.
nb::object ToPyKdl(const Wrench& wrench);
// From a PyKDL.Wrench; nothing for anything else.
std::optional<Wrench> FromPyKdlWrench(nb::handle wrench);
// A PyKDL.JntArray.
nb::object ToPyKdl(std::span<const double> values);

}  // namespace robocell::python

namespace nanobind::detail {

template <>
struct type_caster<robocell::python::PoseOrFrame> {
  NB_TYPE_CASTER(robocell::python::PoseOrFrame, const_name("Pose"))

  bool from_python(handle source, uint8_t, cleanup_list*) noexcept {
    try {
      const robocell::Pose* pose = nullptr;
      if (!try_cast(source, pose) || !pose) {
        if (!hasattr(source, "M") || !hasattr(source, "p")) return false;
        const object made = type<robocell::Pose>()(source);
        value.pose = cast<robocell::Pose>(made);
      } else {
        value.pose = *pose;
      }
      return true;
    } catch (...) {
      PyErr_Clear();
      return false;
    }
  }
};

}  // namespace nanobind::detail
