// The engine's options for the whole scene. They are set after the parts are put together: options
// of the parts would otherwise be lost or mixed. MuJoCo's XML reference, <option>, explains them.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "robocell/spec/fields.h"
#include "robocell/spec/problems.h"
#include "robocell/spec/types.h"

namespace robocell {

enum class Integrator { kEuler, kRk4, kImplicit, kImplicitFast };
template <>
struct EnumNames<Integrator> {
  static constexpr std::array kNames = {std::pair{Integrator::kEuler, "euler"},
                                        std::pair{Integrator::kRk4, "rk4"},
                                        std::pair{Integrator::kImplicit, "implicit"},
                                        std::pair{Integrator::kImplicitFast, "implicitfast"}};
};

enum class FrictionCone { kPyramidal, kElliptic };
template <>
struct EnumNames<FrictionCone> {
  static constexpr std::array kNames = {std::pair{FrictionCone::kPyramidal, "pyramidal"},
                                        std::pair{FrictionCone::kElliptic, "elliptic"}};
};

enum class Solver { kPgs, kCg, kNewton };
template <>
struct EnumNames<Solver> {
  static constexpr std::array kNames = {std::pair{Solver::kPgs, "pgs"},
                                        std::pair{Solver::kCg, "cg"},
                                        std::pair{Solver::kNewton, "newton"}};
};

enum class JacobianKind { kDense, kSparse, kAuto };
template <>
struct EnumNames<JacobianKind> {
  static constexpr std::array kNames = {std::pair{JacobianKind::kDense, "dense"},
                                        std::pair{JacobianKind::kSparse, "sparse"},
                                        std::pair{JacobianKind::kAuto, "auto"}};
};

struct SimOptions {
  Integrator integrator = Integrator::kImplicitFast;
  FrictionCone cone = FrictionCone::kElliptic;
  double impratio = 10;
  std::optional<Solver> solver = {};
  std::optional<JacobianKind> jacobian = {};
  std::optional<int> iterations = {};
  std::optional<double> tolerance = {};
  std::optional<int> ls_iterations = {};
  std::optional<int> noslip_iterations = {};
  std::optional<double> noslip_tolerance = {};
  std::optional<int> ccd_iterations = {};
  std::optional<double> density = {};
  std::optional<double> viscosity = {};
  std::optional<Vec3> wind = {};
  std::vector<std::string> disable = {};
  std::vector<std::string> enable = {};

  static constexpr const char* kTypeName = "SimOptions";
  template <class V>
  static void Fields(V&& v) {
    v("integrator", &SimOptions::integrator, "euler, rk4, implicit or implicitfast.");
    v("cone", &SimOptions::cone, "Friction cones: pyramidal or elliptic.");
    v("impratio", &SimOptions::impratio,
      "Ratio of frictional to normal constraint impedance; high values prevent slip.",
      Bound::kPositive);
    v("solver", &SimOptions::solver, "pgs, cg or newton.");
    v("jacobian", &SimOptions::jacobian,
      "The constraint Jacobian: dense, sparse or auto (sparse from 60 degrees of freedom on). "
      "Unset: the base's value or auto, but dense if this version of the engine computes wrong "
      "results with a sparse one (`robocell doctor`).");
    v("iterations", &SimOptions::iterations, "Largest number of solver iterations.",
      Bound::kPositive);
    v("tolerance", &SimOptions::tolerance, "Tolerance at which the solver ends early.",
      Bound::kNonNegative);
    v("ls_iterations", &SimOptions::ls_iterations, "Largest number of line search iterations.",
      Bound::kPositive);
    v("noslip_iterations", &SimOptions::noslip_iterations, "Iterations of the no-slip pass.",
      Bound::kNonNegative);
    v("noslip_tolerance", &SimOptions::noslip_tolerance,
      "Tolerance at which the no-slip pass ends early.", Bound::kNonNegative);
    v("ccd_iterations", &SimOptions::ccd_iterations,
      "Largest number of iterations of convex collision.", Bound::kPositive);
    v("density", &SimOptions::density, "Density of the medium, kg/m^3.", Bound::kNonNegative);
    v("viscosity", &SimOptions::viscosity, "Viscosity of the medium.", Bound::kNonNegative);
    v("wind", &SimOptions::wind, "Velocity of the medium, m/s.");
    v("disable", &SimOptions::disable,
      "Engine features to turn off, by their names in MuJoCo's <flag>: contact, limit, ...");
    v("enable", &SimOptions::enable, "Engine features to turn on: energy, invdiscrete, sleep, ...");
  }
};

}  // namespace robocell
