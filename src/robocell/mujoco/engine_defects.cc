#include "robocell/mujoco/engine_defects.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <atomic>

#include "robocell/base/log.h"

namespace robocell {
namespace {

constexpr int kFirstWrong = 4000000, kFirstRight = 4000001;

bool IsSparseNewtonWrong(int version) { return version >= kFirstWrong && version < kFirstRight; }

}  // namespace

namespace defects_internal {

std::vector<EngineDefect> DefectsOf(int version) {
  if (!IsSparseNewtonWrong(version)) return {};
  return {{.name = std::string(kSparseNewton),
           .what = "the Newton solver with a sparse Jacobian returns wrong accelerations when "
                   "branching trees such as hands touch each other (MuJoCo #3767)",
           .guard = "models that would use it, those of 60 degrees of freedom or more, are "
                    "compiled with a dense Jacobian; options.jacobian overrules",
           .fixed_in = "4.0.1"},
          {.name = "cylinder_contacts",
           .what = "contacts at the edges of cylinders may be wrong (MuJoCo #3748, #3752)",
           .guard = "",
           .fixed_in = "4.0.1"}};
}

}  // namespace defects_internal

std::vector<EngineDefect> KnownEngineDefects() { return defects_internal::DefectsOf(mj_version()); }

bool NeedsJacobianGuard(const mjModel* model) {
  return IsSparseNewtonWrong(mj_version()) && model->opt.solver == mjSOL_NEWTON &&
         mj_isSparse(model);
}

bool GuardJacobian(mjModel* model) {
  if (!NeedsJacobianGuard(model)) return false;
  model->opt.jacobian = mjJAC_DENSE;
  return true;
}

void LogJacobianGuard(const mjModel* model, std::string_view context) {
  static std::atomic<bool> logged = false;
  if (logged.exchange(true)) return;
  LogInfo(
      fmt::format("{}{}the model has {} degrees of freedom and gets a dense Jacobian, because "
                  "the sparse Newton solver of MuJoCo {} can return wrong accelerations "
                  "(`robocell doctor` lists known defects; options.jacobian overrules). "
                  "Further models are not logged",
                  context, context.empty() ? "" : ": ", model->nv, mj_versionString()));
}

}  // namespace robocell
