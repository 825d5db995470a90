// Tests that objects of the pool rest where they are parked, whatever else is in the model.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/base/error.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// A scene with one object of the pool. The engine compensates no weight in models that were
// compiled without compensated bodies, until their count is set.
SceneSpec OneParked(bool parked = true) {
  SceneSpec spec = EmptyScene();
  spec.objects = {BoxObject("a", {0.5, 0.2, 0.02})};
  spec.objects[0].parked = parked;
  return spec;
}

std::vector<double> FreePose(const Scene& scene, const std::string& body) {
  const mjModel* m = scene.model();
  const mjtNum* pos =
      scene.data()->qpos + m->jnt_qposadr[m->body_jntadr[RequireId(m, mjOBJ_BODY, body, "")]];
  return {pos, pos + 7};
}

TEST(PoolRest, IsExactWithoutOtherCompensatedBodies) {
  ModelFolder folder;
  const std::string arm = folder.Write("arm", kTwoJointArm);
  for (const bool with_robot : {false, true}) {
    for (const bool from_the_start : {true, false}) {
      SceneSpec spec = OneParked(from_the_start);
      if (with_robot) spec.robots.push_back({.path = arm});
      Scene scene = Scene::Build(spec);
      if (!from_the_start) scene.RemoveObject("a");
      const std::vector<double> before = FreePose(scene, "a");
      EXPECT_TRUE(scene.StepN(2000).ok());
      EXPECT_EQ(FreePose(scene, "a"), before) << with_robot << from_the_start;
      scene.SetState(scene.state());
      EXPECT_THAT(scene.parked_objects(), ElementsAre("a"));
    }
  }
}

// Values written to the model mean the same before and after an object was parked.
TEST(PoolRest, DoesNotSwitchOnCompensationThatWasOff) {
  SceneSpec spec = OneParked(false);
  spec.objects.push_back(BoxObject("b", {1, 0, 0.02}));
  Scene scene = Scene::Build(spec);
  const int b = RequireId(scene.model(), mjOBJ_BODY, "b", "");
  scene.mutable_model()->body_gravcomp[b] = 0.5;
  const auto carried = [&] {
    scene.Forward();
    return scene.data()->qfrc_gravcomp[scene.model()->body_dofadr[b] + 2];
  };
  const double before = carried();
  scene.RemoveObject("a");
  EXPECT_EQ(carried(), before);
  EXPECT_NEAR(before, 0.5 * 0.1 * 9.81, 1e-12);
}

TEST(PoolRest, ResistsWrenches) {
  Scene scene = Scene::Build(OneParked());
  ExpectThrow<ArgumentError>(
      [&] {
        scene.SetBodyWrench("a", {1, 0, 0});
      },
      "scene 'test': object 'a' is parked, so nothing can push it; put it "
      "into the scene first, with AddObject (in Python add_object)");
  scene.AddObject("a");
  scene.SetBodyWrench("a", {1, 0, 0});
}

TEST(PoolRest, IsDistinguishedFromAHighPlace) {
  Scene scene = Scene::Build(OneParked());
  scene.AddObject("a", Pose(Eigen::Vector3d(0, 0, 700)));
  EXPECT_TRUE(scene.StepN(10).ok());
  scene.SetState(scene.state());
  EXPECT_THAT(scene.parked_objects(), IsEmpty());
}

// The engine looks at these flags before the numbers: flags set by hand outlive an edit.
TEST(EngineFlags, SurviveAnEdit) {
  SceneSpec spec = EmptyScene();
  spec.objects = {BoxObject("a", {0.5, 0.2, 0.02})};
  Scene scene = Scene::Build(spec);
  mjModel* m = scene.mutable_model();
  m->body_gravcomp[RequireId(m, mjOBJ_BODY, "a", "")] = 1;
  m->flg_gravcomp = true;
  scene.AddObject(BoxObject("b", {1, 0, 0.02}));
  const int a = RequireId(scene.model(), mjOBJ_BODY, "a", "");
  EXPECT_NEAR(scene.data()->qfrc_gravcomp[scene.model()->body_dofadr[a] + 2], 0.1 * 9.81, 1e-12);
}

}  // namespace
}  // namespace robocell
