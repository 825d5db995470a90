// Tests that the engine's options belong to the scene: attached parts lose theirs with a warning.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/base/error.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/robots.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class Options : public ::testing::Test {
 protected:
  mjOption Compiled() {
    scene = CompileScene(spec);
    return scene->model()->opt;
  }

  ModelFolder folder;
  SceneSpec spec = EmptyScene();
  std::shared_ptr<CompiledScene> scene;
};

TEST_F(Options, HaveDefaultsForManipulation) {
  const mjOption option = Compiled();
  EXPECT_EQ(option.integrator, mjINT_IMPLICITFAST);
  EXPECT_EQ(option.cone, mjCONE_ELLIPTIC);
  EXPECT_EQ(option.impratio, 10);
  EXPECT_EQ(option.timestep, 0.002);
  EXPECT_EQ(option.gravity[2], -9.81);
  EXPECT_TRUE(option.disableflags & mjDSBL_AUTORESET);
}

TEST_F(Options, AllReachTheModel) {
  spec.timestep = 0.005;
  spec.gravity = {0, 0, -1.6};
  spec.options = {.integrator = Integrator::kEuler,
                  .cone = FrictionCone::kPyramidal,
                  .impratio = 2,
                  .solver = Solver::kCg,
                  .iterations = 7,
                  .tolerance = 1e-5,
                  .ls_iterations = 8,
                  .noslip_iterations = 3,
                  .noslip_tolerance = 1e-4,
                  .ccd_iterations = 9,
                  .density = 1.2,
                  .viscosity = 1e-5,
                  .wind = Vec3{1, 2, 3},
                  .disable = {"gravity"},
                  .enable = {"energy"}};
  const mjOption o = Compiled();
  EXPECT_EQ(o.timestep, 0.005);
  EXPECT_EQ(o.gravity[2], -1.6);
  EXPECT_EQ(o.integrator, mjINT_EULER);
  EXPECT_EQ(o.cone, mjCONE_PYRAMIDAL);
  EXPECT_EQ(o.impratio, 2);
  EXPECT_EQ(o.solver, mjSOL_CG);
  EXPECT_EQ(o.iterations, 7);
  EXPECT_EQ(o.tolerance, 1e-5);
  EXPECT_EQ(o.ls_iterations, 8);
  EXPECT_EQ(o.noslip_iterations, 3);
  EXPECT_EQ(o.noslip_tolerance, 1e-4);
  EXPECT_EQ(o.ccd_iterations, 9);
  EXPECT_EQ(o.density, 1.2);
  EXPECT_EQ(o.viscosity, 1e-5);
  EXPECT_EQ(o.wind[2], 3);
  EXPECT_EQ(o.disableflags, mjDSBL_GRAVITY | mjDSBL_AUTORESET);
  EXPECT_EQ(o.enableflags, mjENBL_ENERGY);
}

TEST_F(Options, OfTheBaseApplyUnlessTheSceneSetsThem) {
  spec.base = folder.Write("lab", R"(<option timestep="0.004" iterations="33"/>)");
  spec.timestep.reset();
  const mjOption option = Compiled();
  EXPECT_EQ(option.timestep, 0.004);
  EXPECT_EQ(option.iterations, 33);
  EXPECT_EQ(option.cone, mjCONE_ELLIPTIC);
}

TEST_F(Options, RejectAnInvalidTimestepOfTheBase) {
  spec.base = folder.Write("lab", R"(<option timestep="1e-9"/>)");
  spec.timestep.reset();
  ExpectThrow<SpecError>([&] { Compiled(); },
                         "base: <option timestep>: 1e-09 s is too short for a step of the engine, "
                         "at least 1e-05 s");
}

TEST_F(Options, OfPartsAreReportedAndIgnored) {
  const std::string rubber = folder.Write(
      "rubber",
      R"(<option integrator="RK4" impratio="4" noslip_iterations="5"><flag contact="disable" energy="enable"/></option>
      <worldbody><body name="b"><geom size="0.1"/></body></worldbody>)");
  spec.objects.push_back({.name = "duck", .mjcf_path = rubber});
  const mjOption option = Compiled();
  EXPECT_EQ(option.impratio, 10);
  EXPECT_EQ(option.disableflags, mjDSBL_AUTORESET);
  EXPECT_THAT(
      scene->warnings(),
      ElementsAre(HasSubstr("object 'duck': sets integrator rk4, but the scene uses implicitfast"),
                  HasSubstr("sets impratio 4, but the scene uses 10"),
                  HasSubstr("sets noslip_iterations 5, but the scene uses 0"),
                  HasSubstr("disables 'contact'"), HasSubstr("enables 'energy'")));
}

TEST_F(Options, EqualToThoseOfTheSceneAreNotReported) {
  spec.options.disable = {"contact"};
  spec.options.enable = {"energy"};
  spec.options.iterations = 7;
  const std::string rubber = folder.Write(
      "rubber",
      R"(<option iterations="7" integrator="implicitfast"><flag contact="disable" energy="enable" autoreset="disable"/></option>
      <worldbody><body name="b"><geom size="0.1"/></body></worldbody>)");
  spec.objects.push_back({.name = "duck", .mjcf_path = rubber});
  Compiled();
  EXPECT_THAT(scene->warnings(), IsEmpty());
}

TEST_F(Options, OfTheBaseThatTheSceneReplacesAreReported) {
  spec.base = folder.Write(
      "lab", R"(<option cone="elliptic" integrator="RK4" iterations="33" gravity="0 0 -1.6"/>)");
  Compiled();
  EXPECT_THAT(scene->warnings(),
              ElementsAre(HasSubstr("base: sets integrator rk4, but the scene uses implicitfast"),
                          HasSubstr("base: sets gravity")));
}

TEST_F(Options, OfRealRobotsMatchTheDefaults) {
  REQUIRE_MENAGERIE("kinova_gen3", "robotiq_2f85");
  spec.robots.push_back(Gen3With2F85());
  const mjOption option = Compiled();
  EXPECT_EQ(option.integrator, mjINT_IMPLICITFAST);
  EXPECT_EQ(option.cone, mjCONE_ELLIPTIC);
  EXPECT_EQ(option.impratio, 10);
  EXPECT_THAT(scene->warnings(), IsEmpty());
  spec.options.cone = FrictionCone::kPyramidal;
  Compiled();
  EXPECT_THAT(
      scene->warnings(),
      ElementsAre(HasSubstr(
          "robot 'robot' / attachment 'g_': sets cone elliptic, but the scene uses pyramidal")));
}

TEST_F(Options, WithUnknownFlagsSuggestTheRightOnes) {
  spec.options.disable = {"contcat"};
  spec.options.enable = {"sleeep"};
  const std::string message =
      ExpectThrow<SpecError>([&] { Compiled(); }, "options.disable: no flag 'contcat'.");
  EXPECT_THAT(message, HasSubstr("Did you mean 'contact'?"));
  EXPECT_THAT(message, HasSubstr("options.enable: no flag 'sleeep'."));
}

}  // namespace
}  // namespace robocell::internal
