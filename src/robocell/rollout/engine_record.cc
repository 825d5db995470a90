#include "robocell/rollout/engine_record.h"

#include <mujoco/mujoco.h>

#include <nlohmann/json.hpp>

namespace robocell {
namespace {

const char* JacobianName(int jacobian) {
  return jacobian == mjJAC_DENSE ? "dense" : jacobian == mjJAC_SPARSE ? "sparse" : "auto";
}

const char* SolverName(int solver) {
  return solver == mjSOL_PGS ? "pgs" : solver == mjSOL_CG ? "cg" : "newton";
}

}  // namespace

nlohmann::json EngineRecord(const Scene& scene) {
  const mjOption& used = scene.model()->opt;
  nlohmann::json guards = nlohmann::json::array();
  // A user may have written another one into the model since.
  if (used.jacobian == mjJAC_DENSE) guards = scene.compiled()->engine_guards();
  return {{"jacobian", JacobianName(used.jacobian)},
          {"solver", SolverName(used.solver)},
          {"guards", guards}};
}

void RestoreEngine(const nlohmann::json& metadata, SceneSpec& scene) {
  if (scene.options.jacobian) return;
  const auto engine = metadata.find("engine");
  if (engine == metadata.end()) {
    scene.options.jacobian = JacobianKind::kAuto;
  } else if (!engine->value("guards", nlohmann::json::array()).empty()) {
    scene.options.jacobian = JacobianKind::kDense;
  }
}

}  // namespace robocell
