// An episode says how its engine solved, and its scene solves so again.
#include "robocell/rollout/engine_record.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <nlohmann/json.hpp>

#include "robocell/base/error.h"
#include "robocell/mujoco/engine_defects.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using nlohmann::json;

// Ten boxes have 60 degrees of freedom.
SceneSpec ManyBoxes(int count) {
  SceneSpec spec{.name = "boxes", .timestep = 0.002, .add_floor = true, .add_skybox = true};
  for (int i = 0; i < count; ++i) {
    spec.objects.push_back({.name = "box" + std::to_string(i),
                            .shape = Shape::kBox,
                            .size = Vec3{0.02, 0.02, 0.02},
                            .rgba = Vec4{1, 0.5, 0, 1},
                            .mass = 0.1,
                            .friction = Vec3{0.8, 0.02, 0.001},
                            .pos = {0.1 * i, 0, 0.02}});
  }
  return spec;
}

TEST(EngineRecord, NamesJacobianSolverAndGuards) {
  EXPECT_EQ(EngineRecord(Scene::Build(ManyBoxes(3))),
            json::parse(R"({"jacobian": "auto", "solver": "newton", "guards": []})"));
  if (KnownEngineDefects().empty()) GTEST_SKIP() << "this engine has no known defect";
  Scene guarded = Scene::Build(ManyBoxes(10));
  EXPECT_EQ(EngineRecord(guarded), json::parse(R"({"jacobian": "dense", "solver": "newton",
                                                   "guards": ["sparse_newton"]})"));
  guarded.mutable_model()->opt.jacobian = mjJAC_SPARSE;
  EXPECT_EQ(EngineRecord(guarded),
            json::parse(R"({"jacobian": "sparse", "solver": "newton", "guards": []})"));
  SceneSpec overruled = ManyBoxes(10);
  overruled.options.jacobian = JacobianKind::kSparse;
  EXPECT_EQ(EngineRecord(Scene::Build(overruled)),
            json::parse(R"({"jacobian": "sparse", "solver": "newton", "guards": []})"));
}

TEST(EngineRecord, IsRestoredWithAnyEngine) {
  const auto Restored = [](const char* metadata, SceneSpec spec = ManyBoxes(10)) {
    RestoreEngine(json::parse(metadata), spec, "episode 'e'");
    return spec.options.jacobian;
  };
  EXPECT_EQ(Restored(R"({"engine": {"jacobian": "dense", "guards": ["sparse_newton"]}})"),
            JacobianKind::kDense);
  EXPECT_EQ(Restored(R"({"engine": {"jacobian": "auto", "guards": []}})"), std::nullopt);
  // The user wrote this into the model.
  EXPECT_EQ(Restored(R"({"engine": {"jacobian": "sparse", "guards": []}})"), JacobianKind::kSparse);
  EXPECT_EQ(Restored(R"({"engine": {"jacobian": "dense", "guards": []}})"), JacobianKind::kDense);
  // An episode that is older than the guard.
  EXPECT_EQ(Restored("{}"), JacobianKind::kAuto);
  SceneSpec own = ManyBoxes(10);
  own.options.jacobian = JacobianKind::kSparse;
  EXPECT_EQ(Restored("{}", own), JacobianKind::kSparse);
}

TEST(EngineRecord, ThatIsDamagedIsNamed) {
  for (const char* metadata :
       {R"({"engine": 5})", R"({"engine": null})", R"({"engine": "x"})", R"({"engine": []})",
        R"({"engine": {"guards": 5}})", R"({"engine": {"guards": "x"}})",
        R"({"engine": {"guards": [1]}})", R"({"engine": {"guards": {"a": 1}}})",
        R"({"engine": {"jacobian": 5}})", R"({"engine": {"jacobian": "spars"}})"}) {
    SceneSpec spec = ManyBoxes(1);
    ExpectThrow<SpecError>([&] { RestoreEngine(json::parse(metadata), spec, "episode 'e'"); },
                           "episode 'e': metadata.engine");
  }
}

}  // namespace
}  // namespace robocell
