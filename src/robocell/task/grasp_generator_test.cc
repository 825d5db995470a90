#include "robocell/task/grasp_generator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/motion/gripper_shape.h"
#include "robocell/task/grasp_library.h"
#include "robocell/task/testing/random_hands.h"
#include "robocell/testing/random_values.h"

namespace robocell {
namespace {

using Eigen::Vector3d;

TEST(GenerateGrasps, RandomHandsAreClearOfRandomObjectsUntilTheyClose) {
  Rng rng = Rng::Stream(5, "hands");
  int grasps = 0;
  for (int i = 0; i < 12; ++i) {
    const TempDir folder;
    const std::string hand = WriteRandomHand(rng, folder);
    const SceneObject object = RandomPrimitive(rng);
    const Pose pose(Vector3d(0.6, 0, 0.3), RandomQuaternion(rng));
    const Scene scene = HandBeside(hand, object, pose);
    const Robot robot = Robot::Of(scene, "hand");
    const GraspSet set = GenerateGrasps(robot, "thing", {.samples = 200, .most = 12});
    EXPECT_FALSE(set.grasps.empty()) << i;
    for (const Grasp& grasp : set.grasps) {
      ++grasps;
      EXPECT_GE(DistanceInHand(scene, robot, set.body, grasp.tcp_in_body, grasp.opening),
                0.001 - 1e-5);
      EXPECT_GE(DistanceInHand(scene, robot, set.body, grasp.before(), grasp.opening),
                0.001 - 1e-5);
      // Closed to the width of the object, the pads touch it; round ones beside the lines that
      // measured it.
      EXPECT_LT(DistanceInHand(scene, robot, set.body, grasp.tcp_in_body, grasp.width), 0.002);
    }
  }
  EXPECT_GT(grasps, 60);
}

TEST(GenerateGrasps, AreTheSameWhereverTheObjectIs) {
  Rng rng = Rng::Stream(7, "poses");
  const TempDir folder;
  const std::string hand = WriteRandomHand(rng, folder);
  const SceneObject object = RandomPrimitive(rng);
  std::vector<GraspSet> sets;
  std::set<std::string> keys;
  for (int i = 0; i < 3; ++i) {
    const Scene scene = HandBeside(hand, object, RandomPose(rng));
    const Robot robot = Robot::Of(scene, "hand");
    robot.scene().data()->qpos[0] = 0.3 * i;
    robot.scene().Forward();
    sets.push_back(GenerateGrasps(robot, "thing", {.samples = 100, .most = 10}));
    keys.insert(GraspKey(robot, "thing"));
  }
  EXPECT_EQ(keys.size(), 1u);
  for (const GraspSet& set : sets) {
    ASSERT_EQ(set.grasps.size(), sets[0].grasps.size());
    for (size_t k = 0; k < set.grasps.size(); ++k)
      EXPECT_EQ(set.grasps[k].tcp_in_body, sets[0].grasps[k].tcp_in_body);
  }
}

TEST(GenerateGrasps, ErrorsNameTheFieldAndTheAlternatives) {
  Rng rng = Rng::Stream(8, "errors");
  const TempDir folder;
  const std::string hand = WriteRandomHand(rng, folder);
  const Scene scene = HandBeside(hand, RandomPrimitive(rng));
  const Robot robot = Robot::Of(scene, "hand");
  const auto text = [&](const std::string& body, const GraspOptions& options) -> std::string {
    try {
      GenerateGrasps(robot, body, options);
    } catch (const Error& error) {
      // Stored and remembered grasps do not hide a mistake.
      EXPECT_THROW(GraspsOf(robot, body, options), Error);
      EXPECT_THROW(GraspKey(robot, body, options), Error);
      return error.what();
    }
    return "";
  };
  GraspsOf(robot, "thing", {.samples = 60, .most = 5}, false);
  EXPECT_THAT(text("thing", {.geoms = {"typo"}, .samples = 60, .most = 5}),
              testing::HasSubstr("typo"));
  EXPECT_THAT(text("thin", {}), testing::HasSubstr("Did you mean 'thing'?"));
  EXPECT_THAT(text("thing", {.samples = 0}), testing::HasSubstr("samples must be from 1 to 50000"));
  EXPECT_THAT(text("thing", {.samples = 2'000'000'000}), testing::HasSubstr("got 2000000000"));
  EXPECT_THAT(text("thing", {.most = 2'000'000'000}), testing::HasSubstr("most must be from 1 to"));
  EXPECT_THAT(text("thing", {.kinds = {GraspKind::kSuction}}),
              testing::HasSubstr("kind 'suction' need a suction gripper"));
  EXPECT_THAT(text("thing", {.geoms = {"left_pad"}}),
              testing::HasSubstr("not a colliding part of the body"));
}

std::set<GraspKind> KindsIn(const GraspSet& set) {
  std::set<GraspKind> kinds;
  for (const Grasp& grasp : set.grasps) kinds.insert(grasp.kind);
  return kinds;
}

// Geoms that the caller names are where to grasp; they are handles only for the one who asks for kHandle.
TEST(GenerateGrasps, NamedGeomsAreHandlesOnlyWhenHandlesAreAskedFor) {
  using enum GraspKind;
  Rng rng = Rng::Stream(11, "geoms");
  const TempDir folder;
  const std::string hand = WriteRandomHand(rng, folder);
  AtomicWrite(folder / "tool.xml", R"(<mujoco><worldbody><body name="tool"><freejoint/>
    <geom name="blade" type="box" size=".01 .04 .01" mass=".05"/>
    <geom name="handle" type="box" size=".01 .04 .01" pos="0 .08 0" mass=".05"/></body></worldbody></mujoco>)");
  const Scene scene = HandBeside(
      hand,
      {.name = "thing", .mjcf_path = (folder / "tool.xml").string(), .pos = Vec3{0.6, 0, 0.3}});
  const Robot robot = Robot::Of(scene, "hand");
  const auto make = [&](std::vector<GraspKind> kinds, std::vector<std::string> geoms) {
    return GenerateGrasps(robot, "thing",
                          {.kinds = kinds, .geoms = geoms, .samples = 150, .most = 40});
  };
  const std::vector<GraspKind> others = {kTop, kSide, kAntipodal, kRim};
  for (const std::string geom : {"thing_blade", "thing_handle"}) {
    const GraspSet set = make(others, {geom});
    EXPECT_FALSE(set.grasps.empty()) << geom;
    EXPECT_FALSE(KindsIn(set).contains(kHandle)) << geom;
    EXPECT_EQ(KindsIn(make({kHandle}, {geom})), std::set{kHandle}) << geom;
    const auto end = geom == "thing_blade" ? testing::Matcher<double>(testing::Lt(0.065))
                                           : testing::Matcher<double>(testing::Gt(0.015));
    for (const Grasp& grasp : set.grasps) {
      // The pads are at the part that was named, at most 2.5 cm before it.
      const auto shape = GripperShape::Of(robot.config(), scene.spec().options, scene.timestep());
      const Pose pads = grasp.tcp_in_body * shape->grasp_in_tcp();
      EXPECT_THAT((pads * shape->PadAt(grasp.width)).y(), end) << geom;
    }
  }
  EXPECT_FALSE(KindsIn(make({}, {"thing_blade"})).contains(kHandle));
  EXPECT_EQ(KindsIn(make({}, {"thing_handle"})), std::set{kHandle});
  const GraspSet all = make({}, {});
  EXPECT_TRUE(KindsIn(all).contains(kHandle));
  EXPECT_GT(KindsIn(all).size(), 1u);
}

// A thin plate is above the object, beside which nothing else is: no grasp comes through it, however
// long the approach is. The oracle is the engine at places 2 mm apart.
TEST(GenerateGrasps, TheHandDoesNotPassThroughThinParts) {
  Rng rng = Rng::Stream(12, "plates");
  for (const double length : {0.08, 0.5}) {
    const TempDir folder;
    const std::string hand = WriteRandomHand(rng, folder);
    AtomicWrite(folder / "lamp.xml", R"(<mujoco><worldbody><body name="lamp"><freejoint/>
      <geom name="foot" type="box" size=".012 .012 .03" mass=".05"/>
      <geom name="plate" type="box" size=".05 .05 .001" pos="0 0 .235" mass=".05"/>
      <geom name="bar" type="capsule" size=".002 .1" pos=".2 0 0" mass=".05"/></body></worldbody></mujoco>)");
    const Scene scene = HandBeside(
        hand,
        {.name = "thing", .mjcf_path = (folder / "lamp.xml").string(), .pos = Vec3{0.6, 0, 0.3}});
    const Robot robot = Robot::Of(scene, "hand");
    const GraspSet set = GenerateGrasps(
        robot, "thing",
        {.geoms = {"thing_foot"}, .samples = 100, .most = 15, .approach_length = length});
    EXPECT_FALSE(set.grasps.empty()) << length;
    for (const Grasp& grasp : set.grasps) {
      for (double back = 0.001; back < length; back += 0.002) {
        const Pose at(grasp.tcp_in_body.translation() - back * grasp.approach,
                      grasp.tcp_in_body.quaternion());
        ASSERT_GT(DistanceInHand(scene, robot, set.body, at, grasp.opening), -1e-4)
            << length << " " << back << " " << ToString(grasp.kind);
      }
    }
  }
}

}  // namespace
}  // namespace robocell
