#include "robocell/task/held.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/mujoco/names.h"
#include "robocell/mujoco/sleeping.h"
#include "robocell/scene/testing/scenes.h"

namespace robocell::internal {
namespace {

// A cube in the air with plates of two robots without grippers on both sides of it, and a shelf.
class HeldTest : public ::testing::Test {
 protected:
  HeldTest() {
    const std::string plate = folder_.Write("plate", R"(<worldbody><body name="plate">
      <geom type="box" size=".01 .05 .05"/></body></worldbody>)");
    SceneSpec spec{.name = "held", .timestep = 0.002, .add_floor = false, .add_skybox = true};
    spec.robots.push_back(
        {.name = "left", .path = plate, .prefix = "left_", .pos = {-0.0299, 0, 1}});
    spec.robots.push_back(
        {.name = "right", .path = plate, .prefix = "right_", .pos = {0.0299, 0, 1}});
    spec.objects.push_back(BoxObject("cube", {0, 0, 1}));
    SceneObject shelf = BoxObject("shelf", {0, 0, 0.5});
    shelf.fixed = true;
    spec.objects.push_back(shelf);
    scene_ = Scene::Build(spec);
  }
  void Put(const Eigen::Vector3d& at) {
    scene_->Reset();
    scene_->SetBodyPose("cube", Pose(at));
    scene_->Forward();
  }
  Touching Touches() const { return TouchingBody(*scene_, "cube"); }

  ModelFolder folder_;
  std::optional<Scene> scene_;
};

TEST_F(HeldTest, AnObjectBetweenRobotsIsHeld) {
  Put({0, 0, 1});
  EXPECT_TRUE(Touches().robot);
  EXPECT_FALSE(Touches().other);
  EXPECT_TRUE(OnlyRobotsTouch(*scene_, "cube"));
  EXPECT_TRUE(IsHeld(*scene_, "cube"));
}

TEST_F(HeldTest, AnObjectWithoutContactsIsNotHeld) {
  Put({0, 0, 2});
  EXPECT_FALSE(Touches().robot);
  EXPECT_FALSE(OnlyRobotsTouch(*scene_, "cube"));
  EXPECT_FALSE(IsHeld(*scene_, "cube"));
}

TEST_F(HeldTest, AnObjectOnAShelfIsNotHeld) {
  Put({0, 0, 0.5399});
  EXPECT_FALSE(Touches().robot);
  EXPECT_TRUE(Touches().other);
  EXPECT_FALSE(IsHeld(*scene_, "cube"));
}

// The engine has no contacts between bodies that sleep.
TEST_F(HeldTest, AnObjectThatSleepsOnAShelfTouchesIt) {
  SceneSpec spec = scene_->spec();
  spec.options.enable = {"sleep"};
  scene_ = Scene::Build(spec);
  Put({0, 0, 0.54});
  EXPECT_TRUE(scene_->StepN(1000).ok());
  ASSERT_TRUE(
      Sleeps(scene_->model(), scene_->data(), RequireId(scene_->model(), mjOBJ_BODY, "cube", "")));
  EXPECT_FALSE(Touches().robot);
  EXPECT_TRUE(Touches().other);
  EXPECT_FALSE(IsHeld(*scene_, "cube"));
}

}  // namespace
}  // namespace robocell::internal
