#include "robocell/task/hand_geometry.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <string>
#include <vector>
#include <Eigen/Core>

#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/names.h"
#include "robocell/task/convex_solid.h"
#include "robocell/task/testing/random_hands.h"
#include "robocell/testing/random_values.h"

namespace robocell::internal {
namespace {

// The oracle moves joints and the object in the scene, and measures there.
TEST(HandGeometry, ClearancesAreThoseOfTheScene) {
  Rng rng = Rng::Stream(4, "clearance");
  const TempDir folder;
  const std::string file = WriteRandomHand(rng, folder);
  const Scene scene = HandBeside(file, RandomPrimitive(rng));
  const Robot robot = Robot::Of(scene, "hand");
  const auto shape = GripperShape::Of(robot.config(), scene.spec().options, scene.timestep());
  const std::string body = scene.compiled()->object("thing").root_body;
  const std::vector<int> object =
      CollisionGeomsOf(scene.model(), FindId(scene.model(), mjOBJ_BODY, body));
  int free = 0, near = 0;
  for (int i = 0; i < 60; ++i) {
    const Pose tcp_in_body(RandomVector(rng, 0.08), RandomQuaternion(rng));
    const double gap = rng.Uniform(shape->closed_gap(), shape->open_gap());
    HandGeometry hand(robot, shape);
    const double distance = DistanceInHand(scene, robot, body, tcp_in_body, gap);
    for (const double off : {-2e-4, 2e-4}) {
      const double clearance = distance + off;
      if (clearance < 0 || clearance > 0.04) continue;
      hand.Update();
      // The scene's body has moved into the hand meanwhile; the hand goes to it.
      const Pose there = scene.body_pose(body) * tcp_in_body;
      const bool is_free =
          hand.IsFree({.tcp_in_world = there, .gap = gap, .clearance = clearance}, object);
      EXPECT_EQ(is_free, off < 0) << distance;
      (is_free ? free : near) += 1;
    }
  }
  EXPECT_GT(free, 5);
  EXPECT_GT(near, 5);
}

TEST(HandGeometry, SurfacePointsAreOnTheHand) {
  Rng rng = Rng::Stream(5, "points");
  const TempDir folder;
  const std::string file = WriteThreeFingers(rng, folder);
  const Scene scene = HandBeside(file, RandomPrimitive(rng));
  const Robot robot = Robot::Of(scene, "hand");
  const auto shape = GripperShape::Of(robot.config(), scene.spec().options, scene.timestep());
  const HandGeometry hand(robot, shape);
  EXPECT_EQ(hand.finger_count(), 3);
  const Eigen::Matrix3Xd points = hand.SurfacePoints(shape->open_gap(), 50);
  EXPECT_EQ(points.cols(), 50);
  EXPECT_EQ(hand.SurfacePoints(shape->open_gap(), 50), points) << "always the same";
  EXPECT_LT(points.colwise().norm().maxCoeff(), 0.2);
}

}  // namespace
}  // namespace robocell::internal
