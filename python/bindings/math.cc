// Pose, and motions over time.
#include "robocell/math/pose.h"

#include <fmt/format.h>
#include <nanobind/operators.h>

#include <cmath>

#include "bindings.h"
#include "kinematics.h"
#include "values.h"
#include "robocell/base/error.h"
#include "robocell/math/interpolation.h"

namespace robocell::python {
namespace {

Eigen::Vector3d ToVector(nb::handle value, const char* name) {
  const FieldPath path(name);
  const Numbers numbers(value, path, 3);
  return {numbers[0], numbers[1], numbers[2]};
}

nb::object Vector(const Eigen::Vector3d& v) { return NumberCopy({v.data(), 3}); }

template <int N>
nb::object Matrix(const Eigen::Matrix<double, N, N>& m) {
  const Eigen::Matrix<double, N, N, Eigen::RowMajor> rows = m;
  return NumberCopy({rows.data(), N * N}, {N, N});
}

template <int N>
Eigen::Matrix<double, N, N> ToSquare(nb::handle value, const char* name) {
  const FieldPath path(name);
  const std::vector<double> numbers = ToMatrix(value, path, N, N);
  return Eigen::Map<const Eigen::Matrix<double, N, N, Eigen::RowMajor>>(numbers.data());
}

// Recognises a PyKDL.Frame by its attributes.
bool IsFrame(nb::handle value) {
  return nb::hasattr(value, "M") && nb::hasattr(value, "p") &&
         nb::hasattr(value.attr("M"), "GetQuaternion");
}

Pose FromFrame(nb::handle frame) {
  const FieldPath path("frame");
  const Numbers q(frame.attr("M").attr("GetQuaternion")(), path, 4);
  const nb::object p = frame.attr("p");
  const Numbers xyz(nb::make_tuple(p[0], p[1], p[2]), path, 3);
  return Pose({xyz[0], xyz[1], xyz[2]}, {q[0], q[1], q[2], q[3]});
}

int Given(nb::handle a, nb::handle b, nb::handle c, nb::handle d) {
  return !a.is_none() + !b.is_none() + !c.is_none() + !d.is_none();
}

// Rejects three numbers in the place of the matrix.
void RequireIsNoPosition(nb::handle matrix) {
  if (!nb::hasattr(matrix, "__len__") || nb::len(matrix) != 3 || IsText(matrix)) return;
  if (nb::hasattr(nb::object(matrix[0]), "__len__")) return;
  throw ArgumentError(
      fmt::format("Pose: by position it takes a 4x4 matrix, got 3 numbers; a position is given as "
                  "Pose(translation={})",
                  nb::cast<std::string>(nb::repr(matrix))));
}

Pose MakePose(nb::handle matrix, nb::handle translation, nb::handle quaternion, nb::handle rpy,
              nb::handle rotvec, nb::handle rotation) {
  if (!matrix.is_none()) {
    if (Given(quaternion, rpy, rotvec, rotation) > 0 || !translation.is_none()) {
      throw ArgumentError("Pose: a matrix is the whole pose; give nothing else with it");
    }
    if (const Pose* pose = nullptr; nb::try_cast(matrix, pose) && pose) return *pose;
    if (IsFrame(matrix)) return FromFrame(matrix);
    RequireIsNoPosition(matrix);
    return Pose(ToSquare<4>(matrix, "matrix"));
  }
  if (Given(quaternion, rpy, rotvec, rotation) > 1) {
    throw ArgumentError("Pose: give only one of quaternion, rpy, rotvec and rotation");
  }
  const Eigen::Vector3d xyz =
      translation.is_none() ? Eigen::Vector3d::Zero() : ToVector(translation, "translation");
  if (!rpy.is_none()) return Pose::FromRpy(xyz, ToVector(rpy, "rpy"));
  if (!rotvec.is_none()) return Pose::FromRotvec(xyz, ToVector(rotvec, "rotvec"));
  if (!rotation.is_none()) return Pose(xyz, ToSquare<3>(rotation, "rotation"));
  if (quaternion.is_none()) return Pose(xyz);
  const FieldPath path("quaternion");
  const Numbers q(quaternion, path, 4);
  return Pose(xyz, Quaternion{q[0], q[1], q[2], q[3]});
}

std::string Repr(const Pose& pose) {
  const auto& t = pose.translation();
  const auto& q = pose.quaternion();
  return fmt::format("Pose(translation=[{}, {}, {}], quaternion=[{}, {}, {}, {}])", t[0], t[1],
                     t[2], q[0], q[1], q[2], q[3]);
}

// Exact: the state consists of the numbers themselves.
nb::tuple State(const Pose& pose) {
  const auto& t = pose.translation();
  const auto& q = pose.quaternion();
  return nb::make_tuple(t[0], t[1], t[2], q[0], q[1], q[2], q[3]);
}

void SetState(Pose& pose, nb::handle state) {
  const FieldPath path("state");
  const Numbers n(state, path, 7);
  new (&pose) Pose({n[0], n[1], n[2]}, Quaternion{n[3], n[4], n[5], n[6]});
}

constexpr const char* kDoc =
    R"(A rigid transform in SE(3), immutable; X_AB is the pose of B in A and X_AC = X_AB * X_BC.

Metres and radians; quaternions are xyzw. The quaternion is kept at unit length with w >= 0.

    Pose()                                     the identity
    Pose(translation=[x, y, z], quaternion=[x, y, z, w])
    Pose(translation=[x, y, z], rpy=[r, p, y]) extrinsic xyz: Rz(y) @ Ry(p) @ Rx(r)
    Pose(matrix)                               4x4; also a PyKDL.Frame

Raises ArgumentError for a quaternion whose length is not 1 within 1e-6, a matrix that is no
rigid transform, and numbers that are not finite.

Examples:
    >>> pose = rc.Pose(translation=[0.4, 0, 0.3], rpy=[0, np.pi, 0])
    >>> (pose * pose.inverse()).is_close(rc.Pose())
    True)";

constexpr const char* kInitSignature =
    "def __init__(self, matrix: numpy.typing.ArrayLike | Pose | None = None, *, "
    "translation: numpy.typing.ArrayLike | None = None, "
    "quaternion: numpy.typing.ArrayLike | None = None, "
    "rpy: numpy.typing.ArrayLike | None = None, rotvec: numpy.typing.ArrayLike | None = None, "
    "rotation: numpy.typing.ArrayLike | None = None) -> None";

template <class F>
void DefArray(nb::class_<Pose>& c, const char* name, F getter, const char* doc) {
  static std::vector<std::unique_ptr<std::string>> signatures;
  const std::string& text = *signatures.emplace_back(std::make_unique<std::string>(
      std::string("def ") + name + "(self, /) -> numpy.typing.NDArray[numpy.float64]"));
  c.def_prop_ro(name, getter, nb::sig(text.c_str()), doc);
}

void DefReaders(nb::class_<Pose>& c) {
  DefArray(
      c, "translation", [](const Pose& p) { return Vector(p.translation()); },
      "Translation (3,) in metres, a copy."
      "\n\nExamples:\n"
      "    >>> rc.Pose(translation=[0.4, 0, 0.3]).translation\n"
      "    array([0.4, 0. , 0.3])");
  DefArray(
      c, "quaternion", [](const Pose& p) { return NumberCopy(p.quaternion()); },
      "Quaternion (4,) xyzw, w >= 0, a copy."
      "\n\nExamples:\n"
      "    >>> rc.Pose().quaternion\n"
      "    array([0., 0., 0., 1.])");
  DefArray(
      c, "quaternion_wxyz", [](const Pose& p) { return NumberCopy(p.quaternion_wxyz()); },
      "Returns the quaternion (4,) in MuJoCo's order.");
  DefArray(
      c, "rotation", [](const Pose& p) { return Matrix<3>(p.rotation()); },
      "Rotation matrix (3, 3)."
      "\n\nExamples:\n"
      "    >>> rc.Pose().rotation.shape\n"
      "    (3, 3)");
  DefArray(
      c, "rpy", [](const Pose& p) { return Vector(p.rpy()); },
      "Returns roll, pitch, yaw (3,) in rad, extrinsic xyz; at gimbal lock roll is 0."
      "\n\nExamples:\n"
      "    >>> bool(np.allclose(rc.Pose(rpy=[0, 0, 0.5]).rpy, [0, 0, 0.5]))\n"
      "    True");
  DefArray(
      c, "rotvec", [](const Pose& p) { return Vector(p.rotvec()); },
      "Returns the rotation vector (3,): axis times angle, rad, angle in [0, pi].");
  DefArray(
      c, "matrix", [](const Pose& p) { return Matrix<4>(p.matrix()); },
      "Returns the homogeneous matrix (4, 4)."
      "\n\nExamples:\n"
      "    >>> rc.Pose(translation=[0.4, 0, 0.3]).matrix.shape\n"
      "    (4, 4)");
  DefArray(
      c, "xyzrpy", [](const Pose& p) { return NumberCopy(p.xyzrpy()); },
      "Position and roll, pitch, yaw (6,), metres and rad.");
  c.def_prop_ro("angle", &Pose::angle, "Angle of the rotation in [0, pi], rad.");
}

void DefOperations(nb::class_<Pose>& c) {
  c.def("inverse", &Pose::inverse,
        "Returns the inverse: X_BA of X_AB."
        "\n\nExamples:\n"
        "    >>> tcp_to_base = robot.fk_frame().inverse()")
      .def(nb::self * nb::self, "Composes poses: X_AC = X_AB * X_BC.")
      .def(
          "__matmul__", [](const Pose& a, const Pose& b) { return a * b; }, nb::is_operator(),
          "Returns the product, like *.")
      .def(
          "transform",
          [](const Pose& p, nb::handle point) { return Vector(p * ToVector(point, "point")); },
          nb::arg("point"),
          nb::sig("def transform(self, point: numpy.typing.ArrayLike) -> "
                  "numpy.typing.NDArray[numpy.float64]"),
          "Transforms a point (3,), metres, from B to A."
          "\n\nExamples:\n"
          "    >>> rc.Pose(translation=[0, 0, 1]).transform([0.5, 0, 0])\n"
          "    array([0.5, 0. , 1. ])")
      .def("interpolate", &Pose::interpolate, nb::arg("to"), nb::arg("s"),
           "Interpolates on a straight line and the shortest arc: s = 0 gives this pose, s = 1 "
           "gives `to`."
           "\n\nExamples:\n"
           "    >>> goal = rc.Pose(translation=[0, 0, 0.2])\n"
           "    >>> rc.Pose().interpolate(goal, 0.5).translation\n"
           "    array([0. , 0. , 0.1])")
      .def("limit_translation", &Pose::limit_translation, nb::arg("metres"),
           "Returns the pose with its translation shortened to at most this length.")
      .def("limit_rotation", &Pose::limit_rotation, nb::arg("radians"),
           "Returns the pose with its rotation shortened to at most this angle.")
      .def("is_close", &Pose::is_close, nb::arg("other"), nb::arg("rotation_tolerance") = 1e-8,
           nb::arg("translation_tolerance") = 1e-8,
           "Returns True if the distance (m) and the angle between the rotations (rad) are within "
           "their tolerances."
           "\n\nExamples:\n"
           "    >>> rc.Pose().is_close(rc.Pose(translation=[0, 0, 0.1]))\n"
           "    False")
      .def(
          "to_kdl", &ToKdl, nb::sig("def to_kdl(self) -> typing.Any"),
          "Returns a PyKDL.Frame. Raises ImportError with the install command if PyKDL is missing.")
      .def_static("from_kdl", &FromFrame, nb::arg("frame"),
                  nb::sig("def from_kdl(frame: typing.Any) -> Pose"),
                  "Makes a pose from a PyKDL.Frame.");
}

void BindMotions(nb::module_& m) {
  nb::class_<CoordinateState>(m, "CoordinateState",
                              "State of one coordinate of a motion at one time.")
      .def_ro(
          "position", &CoordinateState::position,
          "Position, in the unit of the coordinate; of minimum_jerk the share of the way, 0 to 1.")
      .def_ro("velocity", &CoordinateState::velocity, "Velocity, per second.")
      .def_ro("acceleration", &CoordinateState::acceleration, "Acceleration, per second squared.")
      .def("__repr__", [](const CoordinateState& s) {
        return fmt::format("CoordinateState(position={}, velocity={}, acceleration={})", s.position,
                           s.velocity, s.acceleration);
      });
  m.def("minimum_jerk", &MinimumJerk, nb::arg("time"), nb::arg("duration"),
        "Returns the CoordinateState of a minimum-jerk motion from 0 at time 0 to 1 at `duration`, "
        "at rest before, after and at both ends. Use its position as the `s` of Pose.interpolate, "
        "or of start + s * (goal - start). Raises ArgumentError for a negative duration."
        "\n\nExamples:\n"
        "    >>> rc.control.minimum_jerk(0.5, duration=1).position\n"
        "    0.5");
  m.def("minimum_jerk_duration", &MinimumJerkDuration, nb::arg("distance"), nb::arg("max_velocity"),
        nb::arg("max_acceleration"),
        "Returns the shortest duration (s) in which a minimum-jerk motion over `distance` keeps "
        "both limits; infinity is no limit. Raises ArgumentError unless limits are > 0 and the "
        "distance is finite.");
  m.def(
      "joint_move_duration",
      [](nb::handle start, nb::handle goal, nb::handle velocity, nb::handle acceleration) {
        const FieldPath from("start"), to("goal"), v("max_velocity"), a("max_acceleration");
        return JointMoveDuration(Numbers(start, from), Numbers(goal, to), Numbers(velocity, v),
                                 Numbers(acceleration, a));
      },
      nb::arg("start"), nb::arg("goal"), nb::arg("max_velocity"), nb::arg("max_acceleration"),
      nb::sig("def joint_move_duration(start: object, goal: object, max_velocity: object, "
              "max_acceleration: object) -> float"),
      "Returns the shortest duration (s) in which minimum-jerk motions of all joints, which start "
      "and arrive together, keep their limits: (n,) each, rad/s and rad/s^2, or m. Raises "
      "ArgumentError for different sizes."
      "\n\nExamples:\n"
      "    >>> rc.control.joint_move_duration([0, 0], [0.5, 1], [1, 1], [4, 4]) > 1\n"
      "    True");
  m.def(
      "pose_move_duration",
      [](const PoseOrFrame& start, const PoseOrFrame& goal, double linear_velocity,
         double linear_acceleration, double angular_velocity, double angular_acceleration) {
        return PoseMoveDuration(
            start.get(), goal.get(),
            {linear_velocity, linear_acceleration, angular_velocity, angular_acceleration});
      },
      nb::arg("start"), nb::arg("goal"), nb::kw_only(), nb::arg("linear_velocity") = HUGE_VAL,
      nb::arg("linear_acceleration") = HUGE_VAL, nb::arg("angular_velocity") = HUGE_VAL,
      nb::arg("angular_acceleration") = HUGE_VAL,
      nb::sig("def pose_move_duration(start: Pose, goal: Pose, *, linear_velocity: float = inf, "
              "linear_acceleration: float = inf, angular_velocity: float = inf, "
              "angular_acceleration: float = inf) -> float"),
      "Returns the shortest duration (s) in which start.interpolate(goal, minimum_jerk(t, "
      "duration).position) keeps the limits: m/s, m/s^2, rad/s, rad/s^2.");
}

}  // namespace

nb::object ImportPyKdl() {
  try {
    return nb::module_::import_("PyKDL");
  } catch (nb::python_error& e) {
    if (!e.matches(PyExc_ImportError)) throw;
    const nb::object remedy = nb::module_::import_("robocell._pykdl").attr("remedy")();
    nb::raise_from(e, PyExc_ImportError, "this needs PyKDL, which is not importable here. %s",
                   nb::cast<std::string>(remedy).c_str());
  }
}

nb::object ToKdl(const Pose& pose) {
  const nb::object kdl = ImportPyKdl();
  const auto& q = pose.quaternion();
  const auto& p = pose.translation();
  return kdl.attr("Frame")(kdl.attr("Rotation").attr("Quaternion")(q[0], q[1], q[2], q[3]),
                           kdl.attr("Vector")(p[0], p[1], p[2]));
}

void BindMath(nb::module_& m) {
  BindMotions(m);
  nb::class_<Pose> c(m, "Pose", kDoc);
  c.def(
      "__init__",
      [](Pose* self, nb::handle matrix, nb::handle translation, nb::handle quaternion,
         nb::handle rpy, nb::handle rotvec, nb::handle rotation) {
        new (self) Pose(MakePose(matrix, translation, quaternion, rpy, rotvec, rotation));
      },
      nb::arg("matrix") = nb::none(), nb::kw_only(), nb::arg("translation") = nb::none(),
      nb::arg("quaternion") = nb::none(), nb::arg("rpy") = nb::none(),
      nb::arg("rotvec") = nb::none(), nb::arg("rotation") = nb::none(), nb::sig(kInitSignature));
  DefReaders(c);
  DefOperations(c);
  c.def(nb::self == nb::self, "Returns True for exact equality.");
  c.def("__hash__", [](const Pose& p) { return nb::hash(State(p)); });
  c.def("__repr__", &Repr);
  c.def("__getstate__", &State, nb::sig("def __getstate__(self) -> tuple[float, ...]"));
  c.def("__setstate__", &SetState,
        nb::sig("def __setstate__(self, state: tuple[float, ...]) -> None"));
  c.def("__copy__", [](const Pose& p) { return p; });
  c.def(
      "__deepcopy__", [](const Pose& p, nb::handle) { return p; },
      nb::sig("def __deepcopy__(self, memo: typing.Any, /) -> Pose"));
}

}  // namespace robocell::python
