#include "robocell/task/base_stances.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <string>
#include <vector>
#include <Eigen/Core>

#include "robocell/base/rng.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/scenes/scene_annotations.h"
#include "robocell/task/base_placement.h"
#include "robocell/task/door_swings.h"
#include "robocell/testing/pick_scene.h"

namespace robocell::internal {
namespace {

// A room with a door and boxes that stand, hang and lie about, and the robot of the demo.
Scene Room(ModelFolder& folder, Rng& rng) {
  SceneSpec spec = EmptyScene();
  const std::string door = folder.Write(
      "door",
      "<worldbody><body name=\"frame\"><body name=\"leaf\"><joint name=\"hinge\" axis=\"0 0 1\" "
      "range=\"0 90\"/><geom type=\"box\" size=\"0.4 0.02 1\" pos=\"0.4 0 1\"/></body></body>"
      "</worldbody>");
  spec.objects.push_back({.name = "door", .mjcf_path = door, .pos = Vec3{1, 0, 0}, .fixed = true});
  for (int i = 0; i < 12; ++i) {
    spec.objects.push_back(
        {.name = "box" + std::to_string(i),
         .shape = Shape::kBox,
         .size = Vec3{rng.Uniform(0.05, 0.4), rng.Uniform(0.05, 0.4), rng.Uniform(0.05, 0.5)},
         .rgba = Vec4{0.5, 0.5, 0.5, 1},
         .mass = 1,
         .friction = Vec3{0.8, 0.02, 0.001},
         .pos = Vec3{rng.Uniform(-2, 2), rng.Uniform(-2, 2), rng.Uniform(0.1, 1.2)},
         .euler = {rng.Uniform(-30, 30), rng.Uniform(-30, 30), rng.Uniform(-180, 180)},
         .fixed = true});
  }
  const RunConfig run = ExampleRun("demo.yaml");
  spec.robots.push_back({.name = "arm", .config = run.robot.config, .prefix = "robot_0/"});
  Scene scene = Scene::Build(spec);
  scene.Reset();
  return scene;
}

// The oracle puts the robot at each place and asks the conditions of starts.
TEST(BaseStances, AreFreeExactlyWhereTheConditionsOfStartsAccept) {
  int free = 0, refused = 0, in_swing = 0;
  for (int seed = 0; seed < 4; ++seed) {
    ModelFolder folder;
    Rng rng = Rng::Stream(seed, "stances");
    Scene scene = Room(folder, rng);
    Robot robot = Robot::Of(scene, "arm");
    const double clearance = seed == 0 ? 0 : 0.03;
    const std::vector<Articulation> doors = DoorsOf(DeriveAnnotations(scene), scene);
    ASSERT_EQ(doors.size(), 1U);
    std::vector<Pose> bases;
    for (int i = 0; i < 60; ++i) {
      bases.push_back(Pose::FromRpy({rng.Uniform(-2, 2.2), rng.Uniform(-2, 2), rng.Uniform(0, 0.5)},
                                    {0, 0, rng.Uniform(-3, 3)}));
    }
    scene.Forward();
    const std::vector<double> before = scene.state();
    const mjData* d = scene.data();
    const std::vector<double> places(d->geom_xpos, d->geom_xpos + 3 * scene.model()->ngeom);
    const std::vector<bool> found = BaseStances(robot, clearance, doors).AreFree(bases);
    EXPECT_EQ(scene.state(), before);
    EXPECT_TRUE(std::equal(places.begin(), places.end(), d->geom_xpos));
    for (size_t i = 0; i < bases.size(); ++i) {
      robot.base().SetPose(bases[i]);
      scene.Forward();
      const bool touches = ValidateBaseClearance(scene, robot, clearance).has_value();
      const bool blocks = ValidateDoorSwings(scene, robot, doors, clearance).has_value();
      EXPECT_EQ(found[i], !touches && !blocks) << "seed " << seed << ", place " << i;
      (touches ? refused : blocks ? in_swing : free)++;
    }
  }
  EXPECT_GT(free, 20);
  EXPECT_GT(refused, 20);
  EXPECT_GT(in_swing, 3);
}

}  // namespace
}  // namespace robocell::internal
