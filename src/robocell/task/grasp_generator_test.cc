#include "robocell/task/grasp_generator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "robocell/base/error.h"
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
