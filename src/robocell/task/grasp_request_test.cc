#include "robocell/task/grasp_request.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>
#include <Eigen/Core>

#include "robocell/base/error.h"
#include "robocell/task/testing/random_hands.h"
#include "robocell/testing/random_values.h"

namespace robocell::internal {
namespace {

TEST(KindOfApproach, FollowsTheAngleToTheVerticalOfTheBody) {
  Rng rng = Rng::Stream(15, "directions");
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d way = RandomDirection(rng);
    const double below = std::asin(-way.z()) * 180 / 3.14159265358979;  // degrees
    if (std::abs(below - 45) < 0.1 || std::abs(std::abs(below) - 30) < 0.1) continue;
    const GraspKind expected = below > 45             ? GraspKind::kTop
                               : std::abs(below) < 30 ? GraspKind::kSide
                                                      : GraspKind::kAntipodal;
    EXPECT_EQ(KindOfApproach(way), expected) << way.transpose();
  }
}

TEST(CheckedRequest, FillsInTheKindsThatTheHandCanDo) {
  Rng rng = Rng::Stream(16, "request");
  const TempDir folder;
  const std::string hand = WriteRandomHand(rng, folder);
  const Scene scene = HandBeside(hand, RandomPrimitive(rng));
  const Robot robot = Robot::Of(scene, "hand");
  const GraspRequest all = CheckedRequest(robot, "thing", {});
  EXPECT_TRUE(all.Wants(GraspKind::kRim));
  for (const GraspKind kind : {GraspKind::kSuction, GraspKind::kPush, GraspKind::kHook})
    EXPECT_FALSE(all.Wants(kind)) << ToString(kind);
  EXPECT_TRUE(all.geoms.empty());
  const std::vector<GraspKind> push = {GraspKind::kPush};
  EXPECT_EQ(CheckedRequest(robot, "thing", {.kinds = push}).kinds, push);
  EXPECT_THROW(CheckedRequest(robot, "thing", {.geoms = {"typo"}}), NotFoundError);
  EXPECT_THROW(CheckedRequest(robot, "thing", {.kinds = {GraspKind::kSuction}}), ArgumentError);
}

}  // namespace
}  // namespace robocell::internal
