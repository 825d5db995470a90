// Tests that the guard against the engine's wrong sparse solver holds for every model that a scene
// is made of: compiled, compiled anew, saved, loaded, cached. Hands that touch each other show
// whether the engine needs it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "robocell/assets/resolve.h"
#include "robocell/base/log.h"
#include "robocell/base/rng.h"
#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/engine_defects.h"
#include "robocell/scene/saved_scene.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/scene_cache.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/spec/yaml.h"
#include "robocell/testing/child_test.h"

namespace robocell {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

bool EngineIsGuarded() { return !KnownEngineDefects().empty(); }

// Arms that reach for each other, each with five more hands around its own.
SceneSpec Hands(int arms) {
  SceneSpec spec = EmptyScene();
  spec.name = "hands";
  const RobotConfig rc7 = RobotConfig::Load(assets::BuiltinRobotFile("rc7"));
  for (int a = 0; a < arms; ++a) {
    const double angle = 2 * M_PI * a / arms;
    const std::string arm = "arm" + std::to_string(a);
    spec.robots.push_back({.name = arm,
                           .config = rc7,
                           .prefix = arm + "/",
                           .pos = {0.45 * std::cos(angle), 0.45 * std::sin(angle), 0},
                           .euler = {0, 0, 180 + 360.0 * a / arms}});
    for (int h = 0; h < 5; ++h) {
      const double around = 2 * M_PI * h / 5;
      spec.objects.push_back({.name = arm + "_hand" + std::to_string(h),
                              .mjcf_path = "parallel_hand",
                              .attach_to = {.kind = AttachKind::kBody, .name = arm + "/hand"},
                              .pos = Vec3{0.1 * std::cos(around), 0.1 * std::sin(around), 0.03},
                              .euler = {0, 0, 72.0 * h},
                              .fixed = true});
    }
  }
  return spec;
}

// Enough boxes for 60 degrees of freedom.
SceneSpec Boxes(int count) {
  SceneSpec spec = EmptyScene();
  for (int i = 0; i < count; ++i)
    spec.objects.push_back(BoxObject("box" + std::to_string(i), {0.1 * i, 0, 0.03}));
  return spec;
}

int JacobianOf(const Scene& scene) { return scene.model()->opt.jacobian; }

// The largest difference between the accelerations of two models in the same states, relative to
// the accelerations, and the number of states in which it is visible.
struct Disagreement {
  double largest = 0;
  int states = 0;
};

Disagreement Compare(const mjModel* a, const mjModel* b, int states) {
  const DataPtr da = MakeData(a), db = MakeData(b);
  Rng rng = Rng::Stream(0, "hands");
  Disagreement found;
  for (int k = 0; k < states; ++k) {
    mj_resetData(a, da.get());
    for (int j = 0; j < a->njnt; ++j) {
      if (a->jnt_type[j] == mjJNT_FREE || a->jnt_type[j] == mjJNT_BALL) continue;
      const double low = a->jnt_limited[j] ? a->jnt_range[2 * j] : -3;
      const double high = a->jnt_limited[j] ? a->jnt_range[2 * j + 1] : 3;
      da->qpos[a->jnt_qposadr[j]] = 0.5 * rng.Uniform(low, high);
    }
    mj_resetData(b, db.get());
    mju_copy(db->qpos, da->qpos, a->nq);
    mj_forward(a, da.get());
    mj_forward(b, db.get());
    double size = 0, difference = 0;
    for (int i = 0; i < a->nv; ++i) {
      size = std::max(size, std::abs(da->qacc[i]));
      difference = std::max(difference, std::abs(da->qacc[i] - db->qacc[i]));
    }
    found.largest = std::max(found.largest, difference / (1 + size));
    found.states += difference / (1 + size) > 1e-3;
  }
  return found;
}

constexpr int kStates = 300;

TEST(EngineGuards, TheGuardedSparseSolverIsStillWrongOnHands) {
  SceneSpec spec = Hands(6);
  spec.options.jacobian = JacobianKind::kDense;
  const auto dense = CompileScene(spec);
  spec.options.jacobian = JacobianKind::kSparse;
  const auto sparse = CompileScene(spec);
  const Disagreement found = Compare(dense->model(), sparse->model(), kStates);
  if (!EngineIsGuarded()) {
    EXPECT_EQ(found.states, 0) << "this engine needs a guard: add its version to engine_defects.cc";
    return;
  }
  EXPECT_GT(found.states, 0) << "sparse agrees with dense to " << found.largest << " with MuJoCo "
                             << mj_versionString()
                             << ": the guard may go, see IsSparseNewtonWrong in engine_defects.cc";
}

TEST(EngineGuards, AGuardedSceneOfHandsIsCorrect) {
  const auto guarded = CompileScene(Hands(6));
  EXPECT_GE(guarded->model()->nv, 60);
  SceneSpec spec = Hands(6);
  spec.options.jacobian = JacobianKind::kDense;
  EXPECT_EQ(Compare(guarded->model(), CompileScene(spec)->model(), 50).largest, 0);
}

class Guards : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!EngineIsGuarded()) GTEST_SKIP() << "this engine has no known defect";
  }
};

TEST_F(Guards, ApplyFromSixtyDegreesOfFreedom) {
  const Scene few = Scene::Build(Boxes(9)), many = Scene::Build(Boxes(10));
  EXPECT_EQ(few.model()->nv, 54);
  EXPECT_FALSE(mj_isSparse(few.model()));
  EXPECT_THAT(few.compiled()->engine_guards(), IsEmpty());
  EXPECT_EQ(JacobianOf(many), mjJAC_DENSE);
  EXPECT_THAT(many.compiled()->engine_guards(), ElementsAre("sparse_newton"));
}

TEST_F(Guards, HoldForASmallBaseWithASparseJacobian) {
  ModelFolder folder;
  SceneSpec spec = EmptyScene();
  spec.base = folder.Write("base", R"(<option jacobian="sparse"/>
    <worldbody><body><freejoint/><geom size="0.1"/></body></worldbody>)");
  EXPECT_EQ(JacobianOf(Scene::Build(spec)), mjJAC_DENSE);
  spec.options.solver = Solver::kCg;  // which factorises no Hessian
  const Scene cg = Scene::Build(spec);
  EXPECT_EQ(JacobianOf(cg), mjJAC_SPARSE);
  EXPECT_THAT(cg.compiled()->engine_guards(), IsEmpty());
}

TEST_F(Guards, YieldToTheScenesOptionsWithAWarning) {
  const auto Overruled = [](const char* kind) {
    SceneSpec spec = Boxes(10);
    spec.options =
        FromYamlUnchecked<SceneSpec>(std::string("options: {jacobian: ") + kind + "}").options;
    return Scene::Build(spec);
  };
  const Scene sparse = Overruled("sparse");
  EXPECT_EQ(JacobianOf(sparse), mjJAC_SPARSE);
  EXPECT_THAT(sparse.compiled()->engine_guards(), IsEmpty());
  EXPECT_THAT(sparse.compiled()->warnings(),
              Contains(HasSubstr("options.jacobian: sparse with MuJoCo 4.0.0 and 60 degrees of "
                                 "freedom can give wrong accelerations; leave it unset, or use cg "
                                 "as the solver")));
  EXPECT_EQ(JacobianOf(Overruled("auto")), mjJAC_AUTO);
  const Scene dense = Overruled("dense");
  EXPECT_THAT(dense.compiled()->engine_guards(), IsEmpty());
  EXPECT_THAT(dense.compiled()->warnings(), IsEmpty());
}

TEST_F(Guards, WarnOfASolverThatIsSetAfterCompiling) {
  SceneSpec spec = Boxes(10);
  spec.options.solver = Solver::kCg;
  Scene scene = Scene::Build(spec);
  std::vector<std::string> lines;
  const ScopedLogSink capture([&](LogLevel, std::string_view text) { lines.emplace_back(text); });
  EXPECT_TRUE(scene.StepN(1).ok());
  EXPECT_THAT(lines, IsEmpty());
  scene.mutable_model()->opt.solver = mjSOL_NEWTON;
  EXPECT_TRUE(scene.StepN(1).ok());
  scene.Forward();
  EXPECT_THAT(lines, ElementsAre(HasSubstr("its solver became Newton after the scene was compiled, "
                                           "with a sparse Jacobian of 60 degrees of freedom")));
  scene.mutable_model()->opt.solver = mjSOL_CG;
  EXPECT_TRUE(scene.StepN(1).ok());
  scene.mutable_model()->opt.solver = mjSOL_NEWTON;
  scene.mutable_model()->opt.jacobian = mjJAC_DENSE;
  EXPECT_TRUE(scene.StepN(1).ok());
  EXPECT_EQ(lines.size(), 1u) << "a dense one is right";
}

TEST_F(Guards, HoldWhenAnObjectIsAdded) {
  Scene scene = Scene::Build(Boxes(9));
  EXPECT_EQ(JacobianOf(scene), mjJAC_AUTO);
  scene.AddObject(BoxObject("late", {0, 1, 0.03}));
  EXPECT_EQ(JacobianOf(scene), mjJAC_DENSE);
  EXPECT_THAT(scene.compiled()->engine_guards(), ElementsAre("sparse_newton"));
  scene.RemoveObject("late");
  EXPECT_EQ(JacobianOf(scene), mjJAC_AUTO);
  EXPECT_THAT(scene.compiled()->engine_guards(), IsEmpty());
}

TEST_F(Guards, AreNotReportedAfterSwitchingToSparse) {
  Scene scene = Scene::Build(Boxes(10));
  scene.mutable_model()->opt.jacobian = mjJAC_SPARSE;
  EXPECT_THAT(scene.compiled()->engine_guards(), IsEmpty());
  scene.AddObject(BoxObject("late", {0, 1, 0.03}));
  EXPECT_EQ(JacobianOf(scene), mjJAC_SPARSE);
  EXPECT_THAT(scene.compiled()->engine_guards(), IsEmpty());
  scene.mutable_model()->opt.jacobian = mjJAC_DENSE;
  EXPECT_THAT(scene.compiled()->engine_guards(), ElementsAre("sparse_newton"));
}

TEST_F(Guards, YieldToModelEditsWhenAnObjectIsAdded) {
  Scene scene = Scene::Build(Boxes(10));
  scene.mutable_model()->opt.jacobian = mjJAC_SPARSE;
  scene.AddObject(BoxObject("late", {0, 1, 0.03}));
  EXPECT_EQ(JacobianOf(scene), mjJAC_SPARSE);
}

TEST_F(Guards, AreOverruledInARebuiltScene) {
  SceneSpec spec = Boxes(10);
  spec.options.jacobian = JacobianKind::kSparse;
  Scene scene = Scene::Build(spec);
  scene.AddObject(BoxObject("late", {0, 1, 0.03}));
  EXPECT_EQ(JacobianOf(scene), mjJAC_SPARSE);
}

TEST_F(Guards, AreSavedInXmlAndInBinary) {
  const TempDir folder;
  Scene scene = Scene::Build(Boxes(10));
  const std::string xml = (folder / "scene.xml").string(), mjb = (folder / "scene.mjb").string();
  scene.SaveXml(xml);
  scene.SaveBinary(mjb);
  EXPECT_THAT(scene.ToXml(), HasSubstr("jacobian=\"dense\""));
  const ModelPtr stock(mj_loadXML(xml.c_str(), nullptr, nullptr, 0));
  ASSERT_TRUE(stock);
  EXPECT_EQ(stock->opt.jacobian, mjJAC_DENSE);
  EXPECT_EQ(LoadBinary(mjb)->opt.jacobian, mjJAC_DENSE);
  EXPECT_EQ(internal::CompileSavedScene(Boxes(10), xml)->model()->opt.jacobian, mjJAC_DENSE);
}

TEST_F(Guards, AreOverruledInSavedFiles) {
  const TempDir folder;
  SceneSpec spec = Boxes(10);
  spec.options.jacobian = JacobianKind::kSparse;
  const std::string xml = (folder / "scene.xml").string();
  Scene::Build(spec).SaveXml(xml);
  EXPECT_EQ(internal::CompileSavedScene(spec, xml)->model()->opt.jacobian, mjJAC_SPARSE);
  EXPECT_EQ(internal::CompileSavedScene(Boxes(10), xml)->model()->opt.jacobian, mjJAC_DENSE);
}

TEST_F(Guards, HoldForModelsFromTheCacheAndForCopies) {
  const TempDir folder;
  CompileSceneCached(Boxes(10), folder.path());
  const auto cached = CompileSceneCached(Boxes(10), folder.path());
  EXPECT_EQ(cached->model()->opt.jacobian, mjJAC_DENSE);
  EXPECT_THAT(cached->engine_guards(), ElementsAre("sparse_newton"));
  EXPECT_THAT(cached->Copy()->engine_guards(), ElementsAre("sparse_newton"));
  SceneSpec sparse = Boxes(10);
  sparse.options.jacobian = JacobianKind::kSparse;
  CompileSceneCached(sparse, folder.path());
  EXPECT_EQ(CompileSceneCached(sparse, folder.path())->model()->opt.jacobian, mjJAC_SPARSE);
}

TEST_F(Guards, AreLoggedOncePerProcess) {
  // Runs in a process of its own, because another test of this one has logged it already.
  const ChildRun run = RunTestsInChild("Guards.HoldForModelsFromTheCacheAndForCopies", "");
  EXPECT_TRUE(run.passed) << run.output;
  const std::string line = "scene 'test': the model has 60 degrees of freedom and gets a dense";
  const size_t at = run.output.find(line);
  ASSERT_NE(at, std::string::npos) << run.output;
  EXPECT_EQ(run.output.find(line, at + 1), std::string::npos) << run.output;
}

}  // namespace
}  // namespace robocell
