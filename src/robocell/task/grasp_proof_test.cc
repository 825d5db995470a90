#include "robocell/task/grasp_proof.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/task/grasp_generator.h"
#include "robocell/task/testing/random_hands.h"

namespace robocell {
namespace {

// The oracle is the simulation: the fingers close, and shaking does not get the object out.
TEST(ProveGrasps, MostGeneratedGraspsOfRandomHandsHold) {
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

// A grasp beside the object closes on nothing, and a hand that barely covers its end loses it.
TEST(ProveGrasps, GraspsThatMissTheObjectFail) {
  Rng rng = Rng::Stream(11, "missed");
  const TempDir folder;
  const std::string hand = WriteRandomHand(rng, folder);
  const Scene scene = HandBeside(hand, RandomPrimitive(rng));
  const Robot robot = Robot::Of(scene, "hand");
  GraspSet set = GenerateGrasps(robot, "thing", {.samples = 150, .most = 2});
  ASSERT_FALSE(set.grasps.empty());
  const size_t good = set.grasps.size();
  Grasp beside = set.grasps[0];
  beside.tcp_in_body = Pose(beside.tcp_in_body.translation() - 0.3 * beside.approach,
                            beside.tcp_in_body.quaternion());
  set.grasps.push_back(beside);
  const std::vector<GraspProof> proofs = ProveGrasps(robot, set);
  ASSERT_EQ(proofs.size(), good + 1);
  EXPECT_FALSE(proofs.back().held);
  EXPECT_EQ(proofs.back().failure, "the hand closed on nothing");
  EXPECT_EQ(KeepProven(set, proofs).grasps.size(),
            static_cast<size_t>(std::count_if(proofs.begin(), proofs.end(),
                                              [](const GraspProof& p) { return p.held; })));
}

TEST(ProveGrasps, RejectsWhatHoldsNothing) {
  Rng rng = Rng::Stream(12, "rejected");
  const TempDir folder;
  const std::string hand = WriteRandomHand(rng, folder);
  const Scene scene = HandBeside(hand, RandomPrimitive(rng));
  const Robot robot = Robot::Of(scene, "hand");
  const auto text = [&](const GraspSet& set, const ShakeOptions& options = {}) -> std::string {
    try {
      ProveGrasps(robot, set, options);
    } catch (const ArgumentError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(text({.body = "thing", .grasps = {{.kind = GraspKind::kPush}}}),
              testing::HasSubstr("kind 'push' does not hold anything"));
  EXPECT_THAT(text({.body = "hand", .grasps = {{}}}),
              testing::HasSubstr("Free objects of the scene: thing"));
  const GraspSet none{.body = "thing"};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(text(none, {.seconds = 1e12}), testing::HasSubstr("seconds must be above 0 and"));
  EXPECT_THAT(text(none, {.seconds = nan}), testing::HasSubstr("seconds must be above 0 and"));
  EXPECT_THAT(text(none, {.acceleration = nan}), testing::HasSubstr("acceleration must be"));
  EXPECT_THAT(text(none, {.most_slip = nan}), testing::HasSubstr("most_slip must be"));
}

// In the scene of the proof the robot has the name of its configuration, here that of the object.
TEST(ProveGrasps, AnObjectMayHaveTheNameOfTheRobotsConfiguration) {
  Rng rng = Rng::Stream(14, "names");
  const TempDir folder;
  const std::string hand = WriteRandomHand(rng, folder);
  SceneSpec spec = HandBeside(hand, RandomPrimitive(rng)).spec();
  spec.robots[0].name = "arm";
  spec.robots[0].prefix = "arm/";
  spec.objects[0].name = "hand";
  Scene scene = Scene::Build(spec);
  scene.Reset();
  const Robot robot = Robot::Of(scene, "arm");
  const GraspSet set = GenerateGrasps(robot, spec.objects[0].name, {.samples = 100, .most = 1});
  ASSERT_EQ(set.grasps.size(), 1u);
  EXPECT_EQ(ProveGrasps(robot, set).size(), 1u);
}

}  // namespace
}  // namespace robocell
