#include "robocell/scenes/start_inspector.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// A cube of 4 cm with its middle there, a block of 20 cm in the world's (1, 0, 0.1) and a floor.
Scene Room(const Eigen::Vector3d& cube, bool with_robot = false) {
  SceneSpec spec{.name = "room", .timestep = 0.002, .add_floor = true, .add_skybox = true};
  spec.objects.push_back(BoxObject("cube", ToVec3(cube)));
  SceneObject block = BoxObject("block", {1, 0, 0.1});
  block.size = Vec3{0.1, 0.1, 0.1};
  block.fixed = true;
  spec.objects.push_back(block);
  if (with_robot) spec.robots.push_back({.name = "arm", .config = Rc7(), .prefix = "arm_"});
  Scene scene = Scene::Build(spec);
  scene.Reset();
  return scene;
}

// Returns the problem of the cube there, after a start on the floor was accepted.
std::string WhyNot(const Eigen::Vector3d& cube) {
  Scene scene = Room({0, 0, 0.02});
  StartInspector inspector(scene, {"cube"});
  inspector.Accept();
  scene.SetBodyPose("cube", Pose(cube));
  scene.Forward();
  return inspector.WhyNot();
}

TEST(StartInspector, AcceptsAnObjectAtRest) {
  EXPECT_EQ(WhyNot({0.3, 0, 0.02}), "");
  EXPECT_EQ(WhyNot({1, 0, 0.22}), "") << "on the block";
  EXPECT_EQ(WhyNot({1.13, 0, 0.02}), "") << "beside it";
}

TEST(StartInspector, RejectsFloatingAndPenetratingObjects) {
  EXPECT_THAT(WhyNot({0, 0, 0.3}), HasSubstr("'cube' is 0.28 m above"));
  EXPECT_THAT(WhyNot({1.1, 0, 0.1}), HasSubstr("'cube' is"));
  EXPECT_THAT(WhyNot({1.095, 0, 0.22}), HasSubstr("'cube' reaches over the edge"));
}

TEST(StartInspector, RejectsAnObjectInARobot) {
  Scene scene = Room({0.5, 0.5, 0.02}, true);
  StartInspector inspector(scene, {"cube"});
  inspector.Accept();
  EXPECT_EQ(inspector.WhyNot(), "");
  const Pose hand = Robot::Of(scene, "arm").tcp_in_world();
  scene.SetBodyPose("cube", Pose(hand.translation() + Eigen::Vector3d(0, 0, 0.05)));
  scene.Forward();
  EXPECT_THAT(inspector.WhyNot(), HasSubstr("'cube'"));
}

TEST(StartInspector, IgnoresAcceptedProblems) {
  Scene scene = Room({0, 0, 0.3});
  StartInspector inspector(scene, {"cube"});
  ASSERT_NE(inspector.WhyNot(), "");
  inspector.Accept();
  EXPECT_EQ(inspector.WhyNot(), "") << "it may be dropped from there";
  scene.SetBodyPose("cube", Pose(Eigen::Vector3d(0, 0, 0.5)));
  scene.Forward();
  EXPECT_NE(inspector.WhyNot(), "") << "but from no higher";
}

TEST(StartInspector, LowersAnObjectOntoItsSupport) {
  Scene scene = Room({0, 0, 0.024});
  StartInspector inspector(scene, {"cube"});
  inspector.Accept();
  const BodyPoses lowered = inspector.Lowered({{"cube", Pose(Eigen::Vector3d(0.3, 0, 0.024))}});
  ASSERT_EQ(lowered.size(), 1u);
  EXPECT_NEAR(lowered[0].second.translation().z(), 0.02, 1e-4);
  EXPECT_NEAR(lowered[0].second.translation().x(), 0.3, 1e-9);
}

TEST(StartInspector, UnknownObjectsAreNamed) {
  ExpectThrow<NotFoundError>(
      [] {
        StartInspector(Room({0, 0, 0.02}), {"cub"}).WhyNot();
      },
      "Did you mean 'cube'?");
}

TEST(StartInspector, ReportsObjectsWithoutASupport) {
  EXPECT_THAT(ObjectsOverNothing(Room({0, 0, 0.3})), IsEmpty());
  SceneSpec spec{.name = "air", .timestep = 0.002, .add_floor = false, .add_skybox = true};
  spec.objects.push_back(BoxObject("cube", {0, 0, 1}));
  EXPECT_THAT(ObjectsOverNothing(Scene::Build(spec)), ElementsAre("cube"));
}

TEST(StartInspector, NamesPenetratingObjects) {
  EXPECT_THAT(ObjectsInside(Room({1.05, 0, 0.15})), ElementsAre(HasSubstr("cube")));
  EXPECT_THAT(ObjectsInside(Room({0, 0, 0.02})), IsEmpty());
  EXPECT_THAT(ObjectsInTheFloor(Room({0, 0, -0.01})), ElementsAre(HasSubstr("cube")));
  EXPECT_THAT(ObjectsInTheFloor(Room({0, 0, 0.01})), IsEmpty());
}

}  // namespace
}  // namespace robocell::internal
