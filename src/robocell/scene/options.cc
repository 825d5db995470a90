#include "robocell/scene/options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <span>

#include "robocell/base/suggestions.h"
#include "robocell/spec/timestep.h"

namespace robocell::internal {
namespace {

int Engine(Integrator integrator) {
  switch (integrator) {
    case Integrator::kEuler:
      return mjINT_EULER;
    case Integrator::kRk4:
      return mjINT_RK4;
    case Integrator::kImplicit:
      return mjINT_IMPLICIT;
    case Integrator::kImplicitFast:
      return mjINT_IMPLICITFAST;
  }
  return mjINT_IMPLICITFAST;
}

int Engine(FrictionCone cone) {
  return cone == FrictionCone::kElliptic ? mjCONE_ELLIPTIC : mjCONE_PYRAMIDAL;
}

int Engine(Solver solver) {
  return solver == Solver::kPgs ? mjSOL_PGS : solver == Solver::kCg ? mjSOL_CG : mjSOL_NEWTON;
}

int Engine(JacobianKind jacobian) {
  return jacobian == JacobianKind::kDense    ? mjJAC_DENSE
         : jacobian == JacobianKind::kSparse ? mjJAC_SPARSE
                                             : mjJAC_AUTO;
}

std::vector<std::string> FlagNames(std::span<const char* const> names) {
  std::vector<std::string> out(names.begin(), names.end());
  for (std::string& name : out) std::transform(name.begin(), name.end(), name.begin(), ::tolower);
  return out;
}

// Returns the bits of the named flags.
int FlagBits(const std::vector<std::string>& wanted, std::span<const char* const> flags,
             const char* field, CompileLog& log) {
  const std::vector<std::string> names = FlagNames(flags);
  int bits = 0;
  for (const std::string& flag : wanted) {
    const auto found = std::find(names.begin(), names.end(), flag);
    if (found == names.end()) {
      log.Problem("", NoSuchName(std::string("options.") + field, "flag", flag, names));
    } else {
      bits |= 1 << (found - names.begin());
    }
  }
  return bits;
}

template <class T, class U>
void Set(T& target, const std::optional<U>& value) {
  if (value) target = static_cast<T>(*value);
}

void ApplySolverOptions(const SimOptions& options, mjOption& engine) {
  engine.integrator = Engine(options.integrator);
  engine.cone = Engine(options.cone);
  engine.impratio = options.impratio;
  if (options.solver) engine.solver = Engine(*options.solver);
  if (options.jacobian) engine.jacobian = Engine(*options.jacobian);
  Set(engine.iterations, options.iterations);
  Set(engine.tolerance, options.tolerance);
  Set(engine.ls_iterations, options.ls_iterations);
  Set(engine.noslip_iterations, options.noslip_iterations);
  Set(engine.noslip_tolerance, options.noslip_tolerance);
  Set(engine.ccd_iterations, options.ccd_iterations);
  Set(engine.density, options.density);
  Set(engine.viscosity, options.viscosity);
  if (options.wind) std::copy(options.wind->begin(), options.wind->end(), engine.wind);
}

std::string IntegratorName(int value) {
  constexpr std::array kNames = {"euler", "rk4", "implicit", "implicitfast"};
  const bool known = value >= 0 && value < static_cast<int>(kNames.size());
  return known ? kNames[value] : "another one";
}

std::string ConeName(int value) { return value == mjCONE_ELLIPTIC ? "elliptic" : "pyramidal"; }

std::string SolverName(int value) {
  return value == mjSOL_PGS ? "pgs" : value == mjSOL_CG ? "cg" : "newton";
}

// Compares the options of a part with the engine's defaults and those of the scene.
class OptionComparison {
 public:
  // `scene` are the options that the scene will have.
  OptionComparison(const mjOption& part, const mjOption& scene, const std::string& place,
                   CompileLog& log)
      : part_(part), scene_(scene), place_(place), log_(log) {
    mj_defaultOption(&defaults_);
  }

  // Compares an option by its member, shown with `show`.
  template <class T, class Show>
  void Compare(const char* name, T mjOption::*option, const Show& show) {
    const T requested = part_.*option, used = scene_.*option;
    if (requested == defaults_.*option || requested == used) return;
    log_.Warn(place_, fmt::format("sets {} {}, but the scene uses {}; set it in the scene's "
                                  "options if it matters",
                                  name, show(requested), show(used)));
  }
  template <class T>
  void Compare(const char* name, T mjOption::*option) {
    Compare(name, option, [](T value) { return value; });
  }

  // Compares the flags that the part sets and the scene does not.
  void CompareFlags(int mjOption::*option, std::span<const char* const> flags, const char* verb) {
    const std::vector<std::string> names = FlagNames(flags);
    for (size_t i = 0; i < names.size(); ++i) {
      if (!(part_.*option & ~(scene_.*option) & (1 << i))) continue;
      log_.Warn(place_, fmt::format("{0}s '{1}', the scene does not; list it in options.{0} "
                                    "if it matters",
                                    verb, names[i]));
    }
  }

  void CompareAll() {
    Compare("integrator", &mjOption::integrator, IntegratorName);
    Compare("cone", &mjOption::cone, ConeName);
    Compare("impratio", &mjOption::impratio);
    Compare("solver", &mjOption::solver, SolverName);
    Compare("noslip_iterations", &mjOption::noslip_iterations);
    Compare("iterations", &mjOption::iterations);
    Compare("density", &mjOption::density);
    Compare("viscosity", &mjOption::viscosity);
    CompareFlags(&mjOption::disableflags, mjDISABLESTRING, "disable");
    CompareFlags(&mjOption::enableflags, mjENABLESTRING, "enable");
  }

 private:
  const mjOption part_, scene_;
  const std::string& place_;
  CompileLog& log_;
  mjOption defaults_{};
};

// Returns these options after those of the scene are applied.
mjOption WithSceneOptions(mjOption engine, const SimOptions& scene) {
  CompileLog unknown;  // ApplyOptions reports unknown names once
  ApplySolverOptions(scene, engine);
  engine.disableflags |= FlagBits(scene.disable, mjDISABLESTRING, "disable", unknown);
  engine.disableflags |= mjDSBL_AUTORESET;
  engine.enableflags |= FlagBits(scene.enable, mjENABLESTRING, "enable", unknown);
  return engine;
}

}  // namespace

void ApplyOptions(const SceneSpec& scene, mjSpec* spec, CompileLog& log) {
  ApplySolverOptions(scene.options, spec->option);
  const int enabled = FlagBits(scene.options.enable, mjENABLESTRING, "enable", log);
  const int disabled = FlagBits(scene.options.disable, mjDISABLESTRING, "disable", log);
  spec->option.enableflags |= enabled;
  spec->option.disableflags |= disabled | mjDSBL_AUTORESET;
  if (scene.timestep) spec->option.timestep = *scene.timestep;
  // The spec's own timestep was checked; this one may be that of the base's file.
  const std::string problem = TimestepProblem(spec->option.timestep, 1);
  if (!problem.empty()) log.Problem("base", "<option timestep>: " + problem, "base");
  std::copy(scene.gravity.begin(), scene.gravity.end(), spec->option.gravity);
}

JacobianGuard GuardOf(const SceneSpec& scene) {
  return scene.options.jacobian ? JacobianGuard::kOff : JacobianGuard::kOn;
}

void WarnWrongSolver(const SceneSpec& scene, const mjModel* model, CompileLog& log) {
  if (!scene.options.jacobian || !NeedsJacobianGuard(model)) return;
  log.Warn("", fmt::format("options.jacobian: {} with MuJoCo {} and {} degrees of freedom can "
                           "give wrong accelerations; leave it unset, or use cg as the solver",
                           ToString(*scene.options.jacobian), mj_versionString(), model->nv));
}

void WarnOtherOptions(const mjOption& part, const SimOptions& scene, const std::string& place,
                      CompileLog& log) {
  mjOption defaults;
  mj_defaultOption(&defaults);
  OptionComparison(part, WithSceneOptions(defaults, scene), place, log).CompareAll();
}

void WarnReplacedOptions(const mjOption& base, const SceneSpec& scene, CompileLog& log) {
  mjOption defaults;
  mj_defaultOption(&defaults);
  OptionComparison(base, WithSceneOptions(base, scene.options), "base", log).CompareAll();
  const auto same = [&](const mjtNum* other) { return std::equal(other, other + 3, base.gravity); };
  if (same(defaults.gravity) || same(scene.gravity.data())) return;
  log.Warn("base", fmt::format("sets gravity {}, but the scene uses {}; set it in the scene if it "
                               "matters",
                               fmt::join(base.gravity, " "), fmt::join(scene.gravity, " ")));
}

void DropGlobals(mjSpec* part) {
  mj_defaultOption(&part->option);
  mj_defaultVisual(&part->visual);
  part->authored = mjsAuthored{};
}

}  // namespace robocell::internal
