// What counts as picked: how far an object was lifted, and by whom it is held.
#include "robocell/task/pick_task.h"

#include <gtest/gtest.h>

#include "robocell/base/units.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/spec/run_config.h"

namespace robocell {
namespace {

constexpr double kTop = 0.5;       // of the table, m
constexpr double kPress = 0.0001;  // how far things that touch are pressed into each other, m
constexpr double kLying = kTop + 0.02 - kPress;

// A bar on a table, between the walls of a robot that hold it at any height; a second robot's stop
// is at its end where it is 1 m high. Beside it lies a box, and far away a pan with a lid above it.
// Nothing is simulated: contacts are those of where things are put.
class PickTaskTest : public ::testing::Test {
 protected:
  PickTaskTest() : scene_(Scene::Build(Spec())) {
    scene_.Reset();
    Put("bar", {0, 0, kLying});
  }

  void Put(const std::string& body, const Eigen::Vector3d& at, double pitch = 0) {
    scene_.SetBodyPose(body, Pose::FromRpy(at, {0, pitch, 0}));
    scene_.Forward();
  }

  // Of an episode that begins with things as they are now.
  PickTask Begun(const std::string& object = "bar") const {
    PickTask task(object, "bar", {object}, TaskConfig().lift_height);
    task.Begin(scene_);
    return task;
  }

  ModelFolder folder_;  // before what is built of it
  Scene scene_;

 private:
  SceneSpec Spec() {
    SceneSpec spec = EmptyScene();
    const std::string walls = folder_.Write("walls", R"(<worldbody><body name="hand">
      <geom type="box" size=".1 .01 .5" pos="0 .0299 .75"/>
      <geom type="box" size=".1 .01 .5" pos="0 -.0299 .75"/></body></worldbody>)");
    const std::string stop = folder_.Write("stop", R"(<worldbody><body name="hand">
      <geom type="box" size=".01 .1 .1" pos=".0599 0 1"/></body></worldbody>)");
    spec.robots.push_back({.name = "holding", .path = walls, .prefix = "holding_"});
    spec.robots.push_back({.name = "helping", .path = stop, .prefix = "helping_"});
    SceneObject table = BoxObject("table", {0, 0, kTop / 2});
    table.size = Vec3{0.3, 0.3, kTop / 2};
    table.fixed = true;
    SceneObject bar = BoxObject("bar", {0, 0, kLying});
    bar.size = Vec3{0.05, 0.02, 0.02};
    const std::string pan = folder_.Write("pan", R"(<worldbody><body name="pan"><freejoint/>
      <geom type="box" size=".02 .02 .02"/><body name="lid" pos="0 0 .1"><joint axis="0 1 0"/>
      <geom type="box" size=".01 .01 .01"/></body></body></worldbody>)");
    spec.objects.push_back(table);
    spec.objects.push_back(bar);
    spec.objects.push_back(BoxObject("box", {0.2, 0.2, kTop + 0.02}));
    spec.objects.push_back({.name = "pan", .mjcf_path = pan, .pos = {-2, 0, 1}});
    return spec;
  }
};

TEST_F(PickTaskTest, ACentimetreAboveItsStartIsPicked) {
  PickTask task = Begun();
  EXPECT_FALSE(task.Success(scene_)) << "it lies there";
  Put("bar", {0, 0, kLying + 0.009});
  EXPECT_TRUE(OnlyRobotsTouch(scene_, "bar"));
  EXPECT_FALSE(task.Success(scene_)) << "9 mm";
  EXPECT_NEAR(task.Reward(scene_), 0.009, 1e-12);
  Put("bar", {0, 0, kLying + 0.011});
  EXPECT_TRUE(task.Success(scene_)) << "11 mm";
  EXPECT_NEAR(task.Reward(scene_), 0.011, 1e-12);
  Put("bar", {0, 0, kLying - 0.01});
  EXPECT_EQ(task.Reward(scene_), 0);
}

TEST_F(PickTaskTest, WhatNobodyTouchesIsNotPicked) {
  PickTask task = Begun();
  Put("bar", {1, 0, kLying + 0.1});
  const Touching touching = TouchingBody(scene_, "bar");
  EXPECT_FALSE(touching.robot || touching.other);
  EXPECT_NEAR(task.Reward(scene_), 0.1, 1e-12);
  EXPECT_FALSE(task.Success(scene_)) << "thrown";
}

TEST_F(PickTaskTest, WhatTheTableCarriesTooIsNotPicked) {
  PickTask task = Begun();
  Put("bar", {0, 0, kTop + 0.05 - kPress}, kPi / 2);
  const Touching touching = TouchingBody(scene_, "bar");
  EXPECT_TRUE(touching.robot && touching.other);
  EXPECT_NEAR(task.Reward(scene_), 0.03, 1e-9);
  EXPECT_FALSE(task.Success(scene_)) << "put on its end";
  Put("bar", {0, 0, kTop + 0.051}, kPi / 2);
  EXPECT_TRUE(task.Success(scene_));
}

TEST_F(PickTaskTest, WhatANeighbourTouchesIsNotPicked) {
  PickTask task = Begun();
  Put("bar", {0, 0, kLying + 0.05});
  EXPECT_TRUE(task.Success(scene_)) << "the box touches the table only";
  Put("box", {0, 0, kLying + 0.01 + kPress});
  EXPECT_FALSE(task.Success(scene_)) << "the box is under it";
  Put("box", {0, 0, kLying + 0.09 - kPress});
  EXPECT_FALSE(task.Success(scene_)) << "the box is on it";
  Put("box", {0, 0, kLying + 0.09 + kPress});
  EXPECT_TRUE(task.Success(scene_)) << "the box is near it";
}

TEST_F(PickTaskTest, WhatStartsOnAStackIsLiftedFromThere) {
  Put("box", {0, 0, kLying});
  const double start = kLying + 0.04 - kPress;
  Put("bar", {0, 0, start});
  PickTask task = Begun();
  EXPECT_FALSE(task.Success(scene_));
  EXPECT_EQ(task.Reward(scene_), 0) << "although it is above the table";
  Put("bar", {0, 0, start + 0.009});
  EXPECT_TRUE(OnlyRobotsTouch(scene_, "bar"));
  EXPECT_FALSE(task.Success(scene_));
  Put("bar", {0, 0, start + 0.011});
  EXPECT_TRUE(task.Success(scene_));
  Put("bar", {0, 0, kLying});
  Put("box", {0.2, 0.2, kLying});
  task.Begin(scene_);
  Put("bar", {0, 0, kLying + 0.011});
  EXPECT_TRUE(task.Success(scene_)) << "an episode later it starts lower";
}

TEST_F(PickTaskTest, SeveralRobotsMayHoldIt) {
  PickTask task = Begun();
  const size_t one = (Put("bar", {0, 0, 0.8}), scene_.contacts("bar").size());
  Put("bar", {0, 0, 1});
  EXPECT_GT(scene_.contacts("bar").size(), one) << "the other robot's too";
  EXPECT_TRUE(task.Success(scene_));
}

TEST_F(PickTaskTest, AllPartsOfAnObjectCount) {
  Put("pan_pan", {0, 0, kLying});
  Put("bar", {1, 0, 1});
  PickTask task = Begun("pan");
  Put("pan_pan", {0, 0, kLying + 0.05});
  EXPECT_TRUE(task.Success(scene_));
  Put("box", {0, 0, kLying + 0.05 + 0.1 + 0.03 - kPress});
  EXPECT_FALSE(task.Success(scene_)) << "the box lies on its lid";
}

}  // namespace
}  // namespace robocell
