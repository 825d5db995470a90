// Tests that a robot's base and its first links may overlap without contact, on every base.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <string>

#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/robots.h"
#include "robocell/scene/testing/scenes.h"

namespace robocell {
namespace {

// A turret whose drum reaches into the base; a post of the base stands in the way of the drum's
// arm.
constexpr char kTurret[] = R"(
  <compiler angle="radian"/>
  {}
  <worldbody>
    <body name="base">
      <geom size="0.1 0.1 0.05" type="box"/>
      <body name="post" pos="0.3 0 0"><geom size="0.02 0.3" type="cylinder"/></body>
      <body name="drum" pos="0 0 0.05">
        <joint name="turn" axis="0 0 1" damping="0.1"/>
        <geom size="0.05 0.05" type="cylinder" mass="1"/>
        <body name="arm" pos="0 0 0.2"><joint name="lift" axis="0 1 0"/><geom size="0.02"/></body>
      </body>
    </body>
  </worldbody>)";

class FirstJoints : public testing::Test {
 protected:
  Scene Build(BaseKind base, const std::string& inside = "", SimOptions options = {}) {
    SceneSpec spec = EmptyScene();
    spec.add_floor = false;
    spec.options = std::move(options);
    RobotConfig config{.name = "turret",
                       .model = folder_.Write("turret", fmt::format(kTurret, inside))};
    config.base.kind = base;
    spec.robots.push_back({.config = config});
    return Scene::Build(spec);
  }
  // Rotation after a push of half a second.
  double Pushed(Scene scene) {
    const int joint = RequireId(scene.model(), mjOBJ_JOINT, "turn", "test");
    scene.data()->qfrc_applied[scene.model()->jnt_dofadr[joint]] = 0.01;
    EXPECT_TRUE(scene.StepN(250).ok());
    return scene.data()->qpos[scene.model()->jnt_qposadr[joint]];
  }
  ModelFolder folder_;
};

TEST_F(FirstJoints, TurnAlikeOnFixedAndMovingBases) {
  const double fixed = Pushed(Build(BaseKind::kFixed));
  EXPECT_GT(fixed, 0.01);
  EXPECT_NEAR(fixed, Pushed(Build(BaseKind::kMocap)), 1e-12);
}

TEST_F(FirstJoints, KeepOtherContacts) {
  const Scene scene = Build(BaseKind::kFixed);
  EXPECT_EQ(scene.model()->nexclude, 1);  // not the post
}

TEST_F(FirstJoints, AreFilteredByTheEngineOnAMovingBase) {
  EXPECT_EQ(Build(BaseKind::kMocap).model()->nexclude, 0);
}

TEST_F(FirstJoints, AreNotExcludedTwice) {
  const Scene scene =
      Build(BaseKind::kFixed, R"(<contact><exclude body1="drum" body2="base"/></contact>)");
  EXPECT_EQ(scene.model()->nexclude, 1);
}

TEST_F(FirstJoints, CollideWithoutTheParentFilter) {
  EXPECT_EQ(Build(BaseKind::kFixed, "", {.disable = {"filterparent"}}).model()->nexclude, 0);
}

TEST_F(FirstJoints, TurnAlikeWithAndWithoutAConfiguration) {
  SceneSpec spec = EmptyScene();
  spec.add_floor = false;
  spec.robots.push_back({.path = folder_.Write("turret", fmt::format(kTurret, ""))});
  EXPECT_EQ(Pushed(Scene::Build(spec)), Pushed(Build(BaseKind::kFixed)));
}

TEST_F(FirstJoints, AreExcludedInSavedFilesToo) {
  Scene scene = Build(BaseKind::kFixed);
  const ModelPtr loaded = Compile(ParseXmlString(scene.ToXml()).get());
  ASSERT_EQ(loaded->nexclude, 1);
  EXPECT_EQ(loaded->exclude_signature[0], scene.model()->exclude_signature[0]);
}

TEST_F(FirstJoints, OfTheGen3Turn) {
  REQUIRE_MENAGERIE("kinova_gen3");
  const std::string file = MenagerieModel("kinova_gen3", "gen3.xml");
  for (const RobotSpec& robot :
       {RobotSpec{.config = RobotConfig{.name = "gen3", .model = file}}, RobotSpec{.path = file}}) {
    SceneSpec spec = EmptyScene();
    spec.robots.push_back(robot);
    EXPECT_EQ(Scene::Build(spec).data()->ncon, 0);
  }
}

}  // namespace
}  // namespace robocell
