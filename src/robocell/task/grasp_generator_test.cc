#include "robocell/task/grasp_generator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/motion/gripper_shape.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/task/grasp_library.h"
#include "robocell/task/grasp_proof.h"
#include "robocell/task/testing/random_hands.h"
#include "robocell/testing/pick_scene.h"
#include "robocell/testing/random_values.h"

namespace robocell {
namespace {

using Eigen::Vector3d;

// Moves the object into the hand, opens the fingers by the joints of the gap, and returns the smallest
// distance of hand and object: the engine's own kinematics and distances.
double DistanceInHand(Scene scene, const Robot& robot, const std::string& body,
                      const Pose& tcp_in_body, double gap) {
  const mjModel* m = scene.model();
  const auto shape = GripperShape::Of(robot.config(), scene.spec().options, scene.timestep());
  std::vector<double> joints(shape->joint_names().size());
  shape->JointsAt(gap, joints);
  for (size_t i = 0; i < joints.size(); ++i) {
    const int j = FindId(m, mjOBJ_JOINT, robot.prefix() + shape->joint_names()[i]);
    scene.data()->qpos[m->jnt_qposadr[j]] = joints[i];
  }
  scene.Forward();
  scene.SetBodyPose(body, robot.tcp_in_world() * tcp_in_body.inverse());
  const std::vector<int> object = internal::CollisionGeomsOf(m, FindId(m, mjOBJ_BODY, body));
  const int last = m->jnt_bodyid[FindId(m, mjOBJ_JOINT, robot.joint_names().back())];
  double least = 1;
  for (const int own : robot.geom_ids()) {
    if (!internal::IsCollisionGeom(m, own) || !internal::IsInSubtree(m, m->geom_bodyid[own], last))
      continue;
    for (const int other : object)
      least = std::min(least, mj_geomDistance(m, scene.data(), own, other, 1, nullptr));
  }
  return least;
}

TEST(GenerateGrasps, RandomHandsAreClearOfRandomObjectsUntilTheyClose) {
  Rng rng = Rng::Stream(5, "hands");
  int grasps = 0;
  for (int i = 0; i < 12; ++i) {
    const TempDir folder;
    const std::string hand = WriteRandomHand(rng, folder);
    const Scene scene =
        HandBeside(hand, RandomPrimitive(rng), Pose(Vector3d(0.6, 0, 0.3), RandomQuaternion(rng)));
    const Robot robot = Robot::Of(scene, "hand");
    const GraspSet set = GenerateGrasps(robot, "thing", {.samples = 200, .most = 12});
    EXPECT_FALSE(set.grasps.empty()) << i;
    for (const Grasp& grasp : set.grasps) {
      ++grasps;
      EXPECT_GE(DistanceInHand(scene, robot, set.body, grasp.tcp_in_body, grasp.opening),
                0.001 - 1e-5);
      EXPECT_GE(DistanceInHand(scene, robot, set.body, grasp.before(), grasp.opening),
                0.001 - 1e-5);
      // Closed to the width of the object, the pads touch it.
      EXPECT_LT(DistanceInHand(scene, robot, set.body, grasp.tcp_in_body, grasp.width), 0.0015);
    }
  }
  EXPECT_GT(grasps, 60);
}

// The oracle is the simulation: the fingers close, and shaking does not get the object out.
TEST(GenerateGrasps, MostGraspsOfRandomHandsHoldWhenShaken) {
  Rng rng = Rng::Stream(6, "shaken");
  int held = 0, all = 0;
  for (int i = 0; i < 6; ++i) {
    const TempDir folder;
    const std::string hand = WriteRandomHand(rng, folder);
    const Scene scene = HandBeside(hand, RandomPrimitive(rng));
    const Robot robot = Robot::Of(scene, "hand");
    GraspSet set = GenerateGrasps(robot, "thing", {.samples = 150, .most = 5});
    for (const GraspProof& proof : ProveGrasps(robot, set)) {
      held += proof.held;
      ++all;
    }
  }
  EXPECT_GE(all, 20);
  EXPECT_GE(held, 0.9 * all) << "of " << all;
}

TEST(GenerateGrasps, ThreeFingersCloseAroundObjectsAndHoldThem) {
  Rng rng = Rng::Stream(10, "three fingers");
  int held = 0, all = 0;
  for (int i = 0; i < 4; ++i) {
    const TempDir folder;
    const std::string hand = WriteThreeFingers(rng, folder);
    const Scene scene = HandBeside(hand, RandomPrimitive(rng));
    const Robot robot = Robot::Of(scene, "hand");
    const GraspSet set = GenerateGrasps(
        robot, "thing", {.kinds = {GraspKind::kEnclosing}, .samples = 400, .most = 5});
    EXPECT_FALSE(set.grasps.empty()) << i;
    for (const Grasp& grasp : set.grasps)
      EXPECT_GE(DistanceInHand(scene, robot, set.body, grasp.tcp_in_body, grasp.opening),
                0.001 - 1e-5);
    for (const GraspProof& proof : ProveGrasps(robot, set)) {
      held += proof.held;
      ++all;
    }
  }
  EXPECT_GE(held, 0.7 * all) << "of " << all;
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

std::set<GraspKind> KindsOf(const GraspSet& set) {
  std::set<GraspKind> kinds;
  for (const Grasp& grasp : set.grasps) kinds.insert(grasp.kind);
  return kinds;
}

TEST(GenerateGrasps, FindsTheRimOfAMugAndTheSidesOfABottle) {
  const PickScene mug = MakePickScene(ObjectOnTheTable("mug"));
  const GraspSet of_mug = GenerateGrasps(mug.robot, "target", {.samples = 1500});
  EXPECT_TRUE(KindsOf(of_mug).contains(GraspKind::kRim));
  const PickScene bottle = MakePickScene(ObjectOnTheTable("bottle"));
  const GraspSet of_bottle = GenerateGrasps(bottle.robot, "target", {.samples = 800});
  EXPECT_TRUE(KindsOf(of_bottle).contains(GraspKind::kSide));
  for (size_t i = 1; i < of_bottle.grasps.size(); ++i)
    EXPECT_LE(of_bottle.grasps[i].score, of_bottle.grasps[i - 1].score) << "best first";
}

// The handle of the door is a bar in front of its panel.
TEST(GenerateGrasps, FindsHandlesHooksAndPushesOfACabinet) {
  SceneObject cabinet{.name = "target", .mjcf_path = "cabinet", .pos = Vec3{0.6, 0, 0}};
  const RunConfig run = ExampleRun("demo.yaml");
  SceneSpec spec{.name = "kitchen", .timestep = 0.002, .add_floor = true, .add_skybox = true};
  spec.objects.push_back(cabinet);
  spec.robots.push_back({.name = "rc7", .config = run.robot.config, .prefix = "robot_0/"});
  Scene scene = Scene::Build(spec);
  scene.Reset();
  const Robot robot = Robot::Of(scene, "rc7");
  EXPECT_THAT(HandleGeomsOf(scene, "target_door"),
              testing::UnorderedElementsAre("target_door_handle", "target_door_handle_low",
                                            "target_door_handle_high"));
  for (const char* body : {"target_door", "target_drawer"}) {
    const GraspSet handle =
        GenerateGrasps(robot, body, {.kinds = {GraspKind::kHandle}, .samples = 600, .most = 20});
    EXPECT_GE(handle.grasps.size(), 3u) << body;
    for (const Grasp& grasp : handle.grasps) {
      EXPECT_EQ(grasp.kind, GraspKind::kHandle);
      EXPECT_NEAR(grasp.width, 0.012, 0.002) << "the bar's thickness";
    }
    const GraspSet hooks =
        GenerateGrasps(robot, body, {.kinds = {GraspKind::kHook}, .samples = 600, .most = 10});
    EXPECT_FALSE(hooks.grasps.empty()) << body;
    const GraspSet pushes =
        GenerateGrasps(robot, body, {.kinds = {GraspKind::kPush}, .samples = 200, .most = 10});
    EXPECT_FALSE(pushes.grasps.empty()) << body;
  }
}

TEST(GenerateGrasps, ErrorsNameTheFieldAndTheAlternatives) {
  Rng rng = Rng::Stream(8, "errors");
  const TempDir folder;
  const Scene scene = HandBeside(WriteRandomHand(rng, folder), RandomPrimitive(rng));
  const Robot robot = Robot::Of(scene, "hand");
  const auto text = [&](const std::string& body, const GraspOptions& options) -> std::string {
    try {
      GenerateGrasps(robot, body, options);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(text("thin", {}), testing::HasSubstr("Did you mean 'thing'?"));
  EXPECT_THAT(text("thing", {.samples = 0}), testing::HasSubstr("samples must be at least 1"));
  EXPECT_THAT(text("thing", {.kinds = {GraspKind::kSuction}}),
              testing::HasSubstr("kind 'suction' need a suction gripper"));
  EXPECT_THAT(text("thing", {.geoms = {"left_pad"}}),
              testing::HasSubstr("not a colliding part of the body"));
}

}  // namespace
}  // namespace robocell
