#include "robocell/task/base_stances.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>
#include <Eigen/Core>

#include "robocell/assets/resolve.h"
#include "robocell/base/rng.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/scenes/scene_annotations.h"
#include "robocell/task/base_placement.h"
#include "robocell/task/door_swings.h"
#include "robocell/testing/pick_scene.h"

namespace robocell::internal {
namespace {

// A room with a door, a mat and boxes that stand, hang and lie about, and a robot.
Scene RandomRoom(ModelFolder& folder, const RobotConfig& robot, Rng& rng) {
  SceneSpec spec = EmptyScene();
  spec.add_floor = true;
  spec.objects.push_back({.name = "mat",
                          .shape = Shape::kBox,
                          .size = Vec3{1.5, 1.5, 0.006},
                          .rgba = Vec4{0.5, 0.5, 0.5, 1},
                          .mass = 1,
                          .friction = Vec3{0.8, 0.02, 0.001},
                          .pos = Vec3{-1, -1, 0.006},
                          .fixed = true});
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
  spec.robots.push_back({.name = "arm", .config = robot, .prefix = "robot_0/"});
  Scene scene = Scene::Build(spec);
  scene.Reset();
  return scene;
}

// The oracle puts the robot at each place and asks the conditions of starts.
TEST(BaseStances, AreFreeExactlyWhereTheConditionsOfStartsAccept) {
  const RobotConfig on_pedestal = ExampleRun("demo.yaml").robot.config,
                    mobile = RobotConfig::Load(assets::BuiltinRobotFile("rc7_mobile"));
  int free = 0, refused = 0, in_swing = 0, mobile_free = 0;
  for (int seed = 0; seed < 6; ++seed) {
    const bool is_mobile = seed >= 4;
    ModelFolder folder;
    Rng rng = Rng::Stream(seed, "stances");
    Scene scene = RandomRoom(folder, is_mobile ? mobile : on_pedestal, rng);
    Robot robot = Robot::Of(scene, "arm");
    const double clearance = seed == 0 ? 0 : 0.03;
    const std::vector<Articulation> doors = DoorsOf(DeriveAnnotations(scene), scene);
    ASSERT_EQ(doors.size(), 1U);
    std::vector<Pose> bases;
    for (int i = 0; i < 60; ++i) {
      const Eigen::Vector3d at(rng.Uniform(-2, 2.2), rng.Uniform(-2, 2), rng.Uniform(0, 0.5));
      bases.push_back(
          Pose::FromRpy({at.x(), at.y(), is_mobile ? 0 : at.z()}, {0, 0, rng.Uniform(-3, 3)}));
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
      (touches ? refused : blocks ? in_swing : is_mobile ? mobile_free : free)++;
    }
  }
  EXPECT_GT(free, 20);
  EXPECT_GT(mobile_free, 5) << "on the floor and on the mat";
  EXPECT_GT(refused, 20);
  EXPECT_GT(in_swing, 3);
}

// The oracle is the robot's reach from where it would stand.
TEST(BaseStances, AMobileRobotIsProposedOnItsFloorOnlyForWhatIsNotTooHigh) {
  SceneSpec spec = EmptyScene();
  spec.robots.push_back({.name = "arm",
                         .config = RobotConfig::Load(assets::BuiltinRobotFile("rc7_mobile")),
                         .pos = Vec3{3, 1, 0.1}});
  const Scene scene = Scene::Build(spec);
  const Robot robot = Robot::Of(scene, "arm");
  const Support shelf{Pose(), 0.1, 0.1, 0.01};
  const double highest =
      0.1 + std::sqrt(std::pow(kReachShare * robot.reach(), 2) - std::pow(0.6, 2));
  for (const double height : {0.0, 0.5, highest - 0.01, highest + 0.01, 5.0}) {
    Rng rng = Rng::Stream(2, "shelf");
    const Pose target(Eigen::Vector3d(0, 0, height));
    const std::vector<Pose> bases = BasesAround(robot, shelf, target, {.distance = 0.6}, {}, rng);
    EXPECT_EQ(bases.empty(), height > highest) << height;
    for (const Pose& base : bases) {
      EXPECT_NEAR(base.translation().z(), 0.1, 1e-12);
      robot.base().SetPose(base);
      EXPECT_FALSE(ValidateBaseReach(robot, target).has_value()) << height;
    }
  }
}

}  // namespace
}  // namespace robocell::internal
