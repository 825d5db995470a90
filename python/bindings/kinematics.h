// `robot.kinematics` in Python: the robot's kinematic functions under one name; and conversions
// between kinematics and PyKDL.
#pragma once

#include "bindings.h"
#include "robocell/kinematics/differential_ik.h"
#include "robocell/math/twist.h"
#include "robocell/robot/robot.h"

namespace robocell::python {

struct Kinematics {
  Robot robot;
};

// An argument that is a Pose, a PyKDL.Frame, which has no type that annotations could name, or a
// 4x4 matrix. Other values than a Pose are converted in the function, so that its error explains a
// failed conversion.
struct PoseOrFrame {
  Pose pose;
  nb::object other = {};  // set when it is not a Pose yet

  // Needs the GIL.
  Pose get() const { return other.is_valid() ? nb::cast<Pose>(nb::type<Pose>()(other)) : pose; }
};

// Returns true if the value may be meant as a pose: a Pose, a Frame, or rows of numbers.
bool MayBePose(nb::handle value) noexcept;

// Converts "base", "tip" or "world".
TwistFrame ToTwistFrame(nb::handle name);
const char* TwistFrameName(TwistFrame frame);

// `ik` and `ik_solver` of robots.
void DefRobotIk(nb::class_<Robot>& robot);

// Binds chains that belong to no robot. Needs IkResult to be bound.
void BindChain(nb::module_& m);

// Returns a PyKDL.Chain that lives as long as a copy of `chain`. Raises ImportError with the way to
// get PyKDL.
nb::object ToPyKdl(const Chain& chain);
// Converts a PyKDL.Chain, with limits as for ChainFromSegments. Raises TypeError for anything else.
Chain FromPyKdl(nb::handle chain, std::span<const std::array<double, 2>> limits);
// Returns a PyKDL.Wrench.
nb::object ToPyKdl(const Wrench& wrench);
// Converts a PyKDL.Wrench; unset for anything else.
std::optional<Wrench> FromPyKdlWrench(nb::handle wrench);
// Returns a PyKDL.JntArray.
nb::object ToPyKdl(std::span<const double> values);

}  // namespace robocell::python

namespace nanobind::detail {

template <>
struct type_caster<robocell::python::PoseOrFrame> {
  NB_TYPE_CASTER(robocell::python::PoseOrFrame, const_name("Pose | numpy.typing.ArrayLike"))

  bool from_python(handle source, uint8_t, cleanup_list*) noexcept {
    const robocell::Pose* pose = nullptr;
    if (try_cast(source, pose) && pose) {
      value.pose = *pose;
      return true;
    }
    if (!robocell::python::MayBePose(source)) return false;
    value.other = borrow(source);
    return true;
  }
};

}  // namespace nanobind::detail
