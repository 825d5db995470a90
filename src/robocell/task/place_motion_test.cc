#include "robocell/task/place_motion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/units.h"
#include "robocell/testing/pick_scene.h"

namespace robocell {
namespace {

using ::testing::HasSubstr;

// A box in the hand after a grasp from above: its centre at the TCP, upright.
struct Carrying {
  explicit Carrying(const Eigen::Vector3d& place)
      : pick(MakePickScene(ObjectOnTheTable("box"))),
        planning(pick.planning()),
        upright(pick.scene.body_pose(pick.target_body)),
        object_in_tcp(pick.robot.tcp_in_world().inverse() *
                      Pose(pick.robot.tcp_in_world().translation(), upright.quaternion())),
        motions(planning, object_in_tcp, PosesAbout(place, upright), pick.home(),
                {.above = 0.08, .gap = 0.04}) {}

  PickScene pick;
  PlanningScene planning;
  Pose upright, object_in_tcp;
  PlaceMotions motions;
};

const Eigen::Vector3d kFree(-0.05, 0.15, 0.50);

TEST(PlaceMotions, PlaceTheObjectStraightFromAbove) {
  Carrying carrying(kFree);
  const auto motion = carrying.motions.Next();
  ASSERT_TRUE(motion) << carrying.motions.Reasons();
  const auto object_at = [&](const JointVector& q) {
    return carrying.pick.robot.base_in_world() * carrying.pick.robot.FkFrame(q) *
           carrying.object_in_tcp;
  };
  EXPECT_TRUE(object_at(motion->down.back()).is_close(motion->object_in_world, 1e-3, 1e-3));
  EXPECT_TRUE(object_at(motion->down.back()).translation().isApprox(kFree, 1e-3));
  for (const JointVector& q : motion->down) {
    const Pose object = object_at(q);
    EXPECT_LT((object.translation() - kFree).head<2>().norm(), 1e-3);
    EXPECT_GT((object.rotation() * carrying.upright.rotation().transpose())(2, 2), 0.9999);
    EXPECT_TRUE(carrying.planning.IsFree(q, {.gap = 0.04}));
  }
  EXPECT_NEAR(object_at(motion->down.front()).translation().z(), kFree.z() + 0.08, 1e-3);
}

TEST(PlaceMotions, AreSortedByDistanceToTheStart) {
  Carrying carrying(kFree);
  double before = 0;
  int count = 0;
  while (const auto motion = carrying.motions.Next()) {
    const double distance = JointDistance(motion->down.back(), carrying.pick.home());
    EXPECT_GE(distance, before);
    before = distance;
    ++count;
  }
  EXPECT_GT(count, 4);
}

TEST(PlaceMotions, ExplainWhyNoneExists) {
  Carrying far({0, 3, 0.5});
  EXPECT_FALSE(far.motions.Next());
  EXPECT_EQ(far.motions.Reasons(), "of 16 ways to put it down 16 out of reach");
  Carrying inside({-0.05, 0.15, 0.44});  // the table's top
  EXPECT_FALSE(inside.motions.Next());
  EXPECT_THAT(inside.motions.Reasons(), HasSubstr("in collision (most often"));
  EXPECT_THAT(inside.motions.Reasons(), HasSubstr("with body 'table'"));
}

TEST(PosesAbout, RotateAboutTheVerticalOnly) {
  const Pose tilted = Pose::FromRpy({1, 2, 3}, {0.4, 0.2, 0.1});
  const std::vector<Pose> poses = PosesAbout(kFree, tilted);
  ASSERT_EQ(poses.size(), 16u);
  EXPECT_TRUE(poses[0].is_close({kFree, tilted.quaternion()}, 1e-9, 1e-9));
  for (const Pose& pose : poses) {
    EXPECT_TRUE(pose.rotation().row(2).isApprox(tilted.rotation().row(2), 1e-9));
  }
}

}  // namespace
}  // namespace robocell
