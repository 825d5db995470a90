#include <gtest/gtest.h>

#include "robocell/task/grasp_generator.h"
#include "robocell/task/grasp_proof.h"
#include "robocell/task/testing/random_hands.h"

namespace robocell {
namespace {

TEST(EnclosingGrasps, ThreeFingersCloseAroundObjectsAndHoldThem) {
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

}  // namespace
}  // namespace robocell
