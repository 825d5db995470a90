#include "robocell/rollout/engine_record.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "robocell/base/error.h"

namespace robocell {
namespace {

const char* JacobianName(int jacobian) {
  return jacobian == mjJAC_DENSE ? "dense" : jacobian == mjJAC_SPARSE ? "sparse" : "auto";
}

const char* SolverName(int solver) {
  return solver == mjSOL_PGS ? "pgs" : solver == mjSOL_CG ? "cg" : "newton";
}

// The engine's part of an episode's metadata.
struct EngineText {
  std::string jacobian;
  bool is_guarded = false;
};

EngineText ReadEngine(const nlohmann::json& engine, const std::string& place) {
  const auto require = [&](bool good, const char* field, const char* what) {
    if (good) return;
    throw SpecError(fmt::format(
        "{}: metadata.engine{} is not {}; write it as it was recorded, such as {{\"jacobian\": "
        "\"dense\", \"solver\": \"newton\", \"guards\": [\"sparse_newton\"]}}, or leave engine "
        "out",
        place, field, what));
  };
  require(engine.is_object(), "", "an object");
  const auto guards = engine.find("guards");
  require(guards == engine.end() ||
              (guards->is_array() &&
               std::ranges::all_of(*guards, [](const auto& name) { return name.is_string(); })),
          ".guards", "a list of names");
  const auto jacobian = engine.find("jacobian");
  const bool is_known = jacobian == engine.end() || *jacobian == "dense" || *jacobian == "sparse" ||
                        *jacobian == "auto";
  require(is_known, ".jacobian", "one of dense, sparse and auto");
  return {.jacobian = jacobian == engine.end() ? "auto" : jacobian->get<std::string>(),
          .is_guarded = guards != engine.end() && !guards->empty()};
}

}  // namespace

nlohmann::json EngineRecord(const Scene& scene) {
  const mjOption& used = scene.model()->opt;
  nlohmann::json guards = scene.compiled()->engine_guards();
  return {{"jacobian", JacobianName(used.jacobian)},
          {"solver", SolverName(used.solver)},
          {"guards", guards}};
}

void RestoreEngine(const nlohmann::json& metadata, SceneSpec& scene, const std::string& place) {
  const auto engine = metadata.find("engine");
  const EngineText text =
      engine == metadata.end() ? EngineText{.jacobian = "auto"} : ReadEngine(*engine, place);
  if (scene.options.jacobian) return;
  if (engine == metadata.end()) {
    scene.options.jacobian = JacobianKind::kAuto;
  } else if (text.is_guarded || text.jacobian == "dense") {
    scene.options.jacobian = JacobianKind::kDense;
  } else if (text.jacobian == "sparse") {
    scene.options.jacobian = JacobianKind::kSparse;
  }
}

}  // namespace robocell
