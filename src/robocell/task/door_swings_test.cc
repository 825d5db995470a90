#include "robocell/task/door_swings.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>

#include "robocell/base/rng.h"
#include "robocell/motion/clearance.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/pick_scene.h"

namespace robocell::internal {
namespace {

// A door of `height` m whose hinge stands at x = 1, with the robot of the demo beside it.
struct Doorway {
  ModelFolder folder;
  Scene scene;
  Robot robot;
};

Scene SceneWithDoor(ModelFolder& folder, double height) {
  SceneSpec spec = EmptyScene();
  const std::string h = std::to_string(0.5 * height);
  const std::string model =
      folder.Write("door",
                   "<worldbody><body name=\"frame\"><body name=\"leaf\"><joint name=\"hinge\" "
                   "axis=\"0 0 1\" range=\"0 90\"/>"
                   "<geom type=\"box\" size=\"0.4 0.02 " +
                       h + "\" pos=\"0.4 0 " + h + "\"/></body></body></worldbody>");
  spec.objects.push_back({.name = "door", .mjcf_path = model, .pos = Vec3{1, 0, 0}, .fixed = true});
  const RunConfig run = ExampleRun("demo.yaml");
  spec.robots.push_back({.name = "arm", .config = run.robot.config, .prefix = "robot_0/"});
  Scene scene = Scene::Build(spec);
  scene.Reset();
  return scene;
}

TEST(DoorSwings, OnlyHighHingedPartsAreDoors) {
  ModelFolder folder;
  const Scene high = SceneWithDoor(folder, 2);
  const std::vector<Articulation> doors = DoorsOf(DeriveAnnotations(high), high);
  ASSERT_EQ(doors.size(), 1U);
  EXPECT_EQ(doors[0].joint, "door_hinge");
  const Scene low = SceneWithDoor(folder, 0.8);
  EXPECT_TRUE(DoorsOf(DeriveAnnotations(low), low).empty());
}

TEST(DoorSwings, ARobotIsRefusedExactlyWhereTheDoorWouldTouchItInSomePosture) {
  ModelFolder folder;
  Scene scene = SceneWithDoor(folder, 2);
  Robot robot = Robot::Of(scene, "arm");
  const std::vector<Articulation> doors = DoorsOf(DeriveAnnotations(scene), scene);
  const mjModel* m = scene.model();
  const int joint = FindId(m, mjOBJ_JOINT, "door_hinge");
  int refused = 0;
  for (int seed = 0; seed < 40; ++seed) {
    Rng rng = Rng::Stream(seed, "swing");
    robot.base().SetPose(Pose::FromRpy({rng.Uniform(0, 2.2), rng.Uniform(-0.8, 1.2), 0.3},
                                       {0, 0, rng.Uniform(-3, 3)}));
    scene.Forward();
    const std::vector<double> before = scene.state();
    const bool is_refused = ValidateDoorSwings(scene, robot, doors, 0.01).has_value();
    EXPECT_EQ(scene.state(), before);
    refused += is_refused;
    // The oracle opens the door in fine steps and measures the distance of the whole robot.
    double least = 1;
    for (double angle = 0; angle <= M_PI / 2; angle += 0.03) {
      scene.data()->qpos[m->jnt_qposadr[joint]] = angle;
      scene.Forward();
      least = std::min(least, RobotClearance(scene, robot, 1).distance);
    }
    scene.data()->qpos[m->jnt_qposadr[joint]] = 0;
    scene.Forward();
    // Between the postures of the two, the leaf's tip moves by 3 cm at most.
    if (least < -0.005) {
      EXPECT_TRUE(is_refused) << "seed " << seed << ", " << least;
    }
    if (least > 0.03) {
      EXPECT_FALSE(is_refused) << "seed " << seed << ", " << least;
    }
  }
  EXPECT_GT(refused, 4);
  EXPECT_LT(refused, 36);
}

// A hinge may turn many times; its postures come again after the first turn.
TEST(DoorSwings, AHingeOfManyTurnsIsCheckedForOne) {
  ModelFolder folder;
  Scene scene = SceneWithDoor(folder, 2);
  Robot robot = Robot::Of(scene, "arm");
  std::vector<Articulation> doors = DoorsOf(DeriveAnnotations(scene), scene);
  robot.base().SetPose(Pose({1, 0.4, 0.3}));  // half a meter along the open leaf
  scene.Forward();
  doors[0].range = {0, 1e9};
  EXPECT_TRUE(ValidateDoorSwings(scene, robot, doors, 0.01));
  robot.base().SetPose(Pose({1, 0.4, 5}));  // above it
  scene.Forward();
  EXPECT_FALSE(ValidateDoorSwings(scene, robot, doors, 0.01));
}

}  // namespace
}  // namespace robocell::internal
