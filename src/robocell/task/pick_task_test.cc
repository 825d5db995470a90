// Tests when an object counts as picked: how far it was lifted, and who holds it.
#include "robocell/task/pick_task.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/base/units.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/spec/run_config.h"
#include "robocell/spec/yaml.h"
#include "robocell/task/held.h"

namespace robocell {
namespace {

constexpr double kTop = 0.5;       // of the table, m
constexpr double kPress = 0.0001;  // penetration depth of touching geoms, m
constexpr double kLift = 0.01;     // lift that counts as picked, m
constexpr double kJaws = 5;        // where the gripper is, m
constexpr double kLying = kTop + 0.02 - kPress;

// A bar lies on a table between the walls of a robot that hold it at any height; a second robot's
// stop touches its end where it is 1 m high. Beside it lies a box, and far away stand a pan with a
// lid above it and a robot with a gripper, whose fingers are open by the width of the box plus 1
// cm. Nothing is simulated: the contacts are those of the poses that the tests set.
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

  void PutBetweenFingers(double sideways) { Put("box", {kJaws, sideways, 1}); }
  void Move(const std::string& joint, double q) {
    const mjModel* m = scene_.model();
    scene_.data()->qpos[m->jnt_qposadr[RequireId(m, mjOBJ_JOINT, joint, "test")]] = q;
    scene_.Forward();
  }

  // Returns the task of an episode that begins in the present state.
  PickTask Begun(const std::string& object = "bar") const {
    PickTask task(object, "bar", {object}, kLift);
    task.Begin(scene_);
    return task;
  }

  ModelFolder folder_;  // outlives what is built from it
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
    folder_.Write("jaws", R"(<compiler autolimits="true"/><worldbody><body name="hand">
      <body name="left" pos="0 .03 0"><joint name="left" type="slide" axis="0 -1 0" range="0 .03"
      damping="5"/>
      <geom type="box" size=".02 .005 .1"/></body>
      <body name="right" pos="0 -.03 0"><joint name="right" type="slide" axis="0 1 0"
      range="0 .03" damping="5"/><geom type="box" size=".02 .005 .1"/></body></body></worldbody>
      <actuator><position name="l" joint="left" kp="100" ctrlrange="0 .03"/>
      <position name="r" joint="right" kp="100" ctrlrange="0 .03"/></actuator>)");
    RobotConfig jaws = ParseYaml<RobotConfig>(R"({name: jaws, model: jaws.xml, move_groups: {
      gripper: {kind: gripper, joints: [left, right], actuators: [l, r]}}})",
                                              "jaws.yaml");
    jaws.source_dir = folder_.path().string();
    spec.robots.push_back(
        {.name = "jaws", .config = jaws, .prefix = "jaws_", .pos = {kJaws, 0, 1}});
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
    spec.objects.push_back({.name = "pan", .mjcf_path = pan, .pos = Vec3{-2, 0, 1}});
    return spec;
  }
};

TEST_F(PickTaskTest, ACentimetreAboveItsStartIsPicked) {
  PickTask task = Begun();
  EXPECT_FALSE(task.Judge(scene_).success) << "it lies there";
  Put("bar", {0, 0, kLying + 0.009});
  EXPECT_TRUE(internal::OnlyRobotsTouch(scene_, "bar"));
  EXPECT_FALSE(task.Judge(scene_).success) << "9 mm";
  EXPECT_NEAR(task.Judge(scene_).reward, 0.5 * 0.9, 1e-9) << "without a TCP half is for the height";
  Put("bar", {0, 0, kLying + 0.011});
  EXPECT_TRUE(task.Judge(scene_).success) << "11 mm";
  EXPECT_EQ(task.Judge(scene_).reward, 1);
  Put("bar", {0, 0, kLying - 0.01});
  EXPECT_EQ(task.Judge(scene_).reward, 0);
}

TEST_F(PickTaskTest, AnObjectWithoutContactsIsNotPicked) {
  PickTask task = Begun();
  Put("bar", {1, 0, kLying + 0.1});
  const internal::Touching touching = internal::TouchingBody(scene_, "bar");
  EXPECT_FALSE(touching.robot || touching.other);
  EXPECT_NEAR(task.Judge(scene_).reward, 0.5, 1e-12);
  EXPECT_FALSE(task.Judge(scene_).success) << "thrown";
}

TEST_F(PickTaskTest, AnObjectThatTouchesTheTableIsNotPicked) {
  PickTask task = Begun();
  Put("bar", {0, 0, kTop + 0.05 - kPress}, internal::kPi / 2);
  const internal::Touching touching = internal::TouchingBody(scene_, "bar");
  EXPECT_TRUE(touching.robot && touching.other);
  EXPECT_NEAR(task.Judge(scene_).reward, 0.5, 1e-9);
  EXPECT_FALSE(task.Judge(scene_).success) << "put on its end";
  Put("bar", {0, 0, kTop + 0.051}, internal::kPi / 2);
  EXPECT_TRUE(task.Judge(scene_).success);
}

TEST_F(PickTaskTest, AnObjectThatTouchesAnotherIsNotPicked) {
  PickTask task = Begun();
  Put("bar", {0, 0, kLying + 0.05});
  EXPECT_TRUE(task.Judge(scene_).success) << "the box touches the table only";
  Put("box", {0, 0, kLying + 0.01 + kPress});
  EXPECT_FALSE(task.Judge(scene_).success) << "the box is under it";
  Put("box", {0, 0, kLying + 0.09 - kPress});
  EXPECT_FALSE(task.Judge(scene_).success) << "the box is on it";
  Put("box", {0, 0, kLying + 0.09 + kPress});
  EXPECT_TRUE(task.Judge(scene_).success) << "the box is near it";
}

TEST_F(PickTaskTest, AnObjectOnAStackIsLiftedFromThere) {
  Put("box", {0, 0, kLying});
  const double start = kLying + 0.04 - kPress;
  Put("bar", {0, 0, start});
  PickTask task = Begun();
  EXPECT_FALSE(task.Judge(scene_).success);
  EXPECT_EQ(task.Judge(scene_).reward, 0) << "although it is above the table";
  Put("bar", {0, 0, start + 0.009});
  EXPECT_TRUE(internal::OnlyRobotsTouch(scene_, "bar"));
  EXPECT_FALSE(task.Judge(scene_).success);
  Put("bar", {0, 0, start + 0.011});
  EXPECT_TRUE(task.Judge(scene_).success);
  Put("bar", {0, 0, kLying});
  Put("box", {0.2, 0.2, kLying});
  task.Begin(scene_);
  Put("bar", {0, 0, kLying + 0.011});
  EXPECT_TRUE(task.Judge(scene_).success) << "an episode later it starts lower";
}

TEST_F(PickTaskTest, SeveralRobotsCanHoldIt) {
  PickTask task = Begun();
  const size_t one = (Put("bar", {0, 0, 0.8}), scene_.contacts("bar").size());
  Put("bar", {0, 0, 1});
  EXPECT_GT(scene_.contacts("bar").size(), one) << "the other robot's too";
  EXPECT_TRUE(task.Judge(scene_).success);
}

TEST_F(PickTaskTest, AnObjectOnOneFingerIsNotPicked) {
  PickTask task = Begun("box");
  PutBetweenFingers(0);
  EXPECT_FALSE(internal::TouchingBody(scene_, "box").robot);
  for (const double side : {1.0, -1.0}) {
    PutBetweenFingers(side * (0.005 + kPress));
    EXPECT_TRUE(internal::OnlyRobotsTouch(scene_, "box"));
    EXPECT_GT(task.Judge(scene_).reward, 0.4);
    EXPECT_FALSE(task.Judge(scene_).success) << side;
  }
  PutBetweenFingers(0);
  for (const char* joint : {"jaws_left", "jaws_right"}) Move(joint, 0.005 + kPress);
  EXPECT_TRUE(task.Judge(scene_).success) << "both fingers have it";
  Put("bar", {kJaws, 0, 1 + 0.04 - kPress});
  EXPECT_FALSE(task.Judge(scene_).success) << "and the bar lies on it";
}

TEST_F(PickTaskTest, AllPartsOfAnObjectAreConsidered) {
  Put("pan_pan", {0, 0, kLying});
  Put("bar", {1, 0, 1});
  PickTask task = Begun("pan");
  Put("pan_pan", {0, 0, kLying + 0.05});
  EXPECT_TRUE(task.Judge(scene_).success);
  Put("box", {0, 0, kLying + 0.05 + 0.1 + 0.03 - kPress});
  EXPECT_FALSE(task.Judge(scene_).success) << "the box lies on its lid";
}

}  // namespace
}  // namespace robocell
