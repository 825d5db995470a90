#include "robocell/scene/body_handle.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/base/error.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

Scene TwoCubes() {
  SceneSpec spec = EmptyScene();
  spec.objects.push_back(BoxObject("red", {0, 0, 0.5}));
  spec.objects.push_back(BoxObject("blue", {1, 0, 0.5}));
  return Scene::Build(spec);
}

TEST(BodyHandle, HasThePoseOfTheBodyNow) {
  Scene scene = TwoCubes();
  const BodyHandle blue(scene, "blue");
  EXPECT_EQ(blue.name(), "blue");
  EXPECT_NEAR(blue.pose_in_world().translation().z(), 0.5, 1e-12);
  for (int i = 0; i < 50; ++i) EXPECT_TRUE(scene.Step().ok());
  EXPECT_LT(blue.pose_in_world().translation().z(), 0.5) << "it fell";
  EXPECT_EQ(blue.pose_in_world().translation(), scene.body_pose("blue").translation());
}

TEST(BodyHandle, FollowsItsBodyWhenTheSceneIsCompiledAgain) {
  Scene scene = TwoCubes();
  const BodyHandle blue(scene, "blue");
  scene.RemoveObject("red");
  EXPECT_EQ(blue.id(), mj_name2id(scene.model(), mjOBJ_BODY, "blue"));
  EXPECT_EQ(blue.pose_in_world().translation(), scene.body_pose("blue").translation());
}

TEST(BodyHandle, ARemovedBodyIsAnErrorWithTheOthers) {
  Scene scene = TwoCubes();
  const BodyHandle red(scene, "red");
  scene.RemoveObject("red");
  ExpectThrow<NotFoundError>([&] { red.id(); }, "scene 'test': no body 'red'");
}

TEST(BodyHandle, RejectsAnUnknownName) {
  const Scene scene = TwoCubes();
  ExpectThrow<NotFoundError>([&] { BodyHandle(scene, "bleu"); }, "Did you mean 'blue'?");
}

}  // namespace
}  // namespace robocell
