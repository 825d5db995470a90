#include "robocell/mujoco/joint_followers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <limits>

#include "robocell/mujoco/compile.h"

namespace robocell::internal {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

constexpr double kNoEnd = std::numeric_limits<double>::infinity();

// Joints 0 to 3; 1 and 2 follow 0, and 3 is free.
ModelPtr FollowersModel() {
  return Compile(ParseXmlString(R"(<mujoco><compiler angle="radian"/><worldbody>
      <body><joint name="a" range="-1 2"/><geom size=".1"/>
      <body><joint name="b"/><geom size=".1"/><body><joint name="c"/><geom size=".1"/>
      <body><joint name="d"/><geom size=".1"/></body></body></body></body></worldbody>
      <equality><joint joint1="b" joint2="a" polycoef=".1 2 0 0 0"/>
      <joint joint1="c" joint2="a" polycoef="0 1 .5 0 0"/></equality></mujoco>)",
                                "followers")
                     .get(),
                 nullptr, "followers");
}

TEST(JointFollowers, FollowTheirLeaderOrOneOfItsFollowers) {
  const ModelPtr m = FollowersModel();
  const std::vector<JointFollower> of_leader = FollowersOf(m.get(), std::vector<int>{3, 0});
  ASSERT_THAT(of_leader, SizeIs(2));
  EXPECT_EQ(of_leader[0].joint, 1);
  EXPECT_EQ(of_leader[0].leader, 1U);
  EXPECT_DOUBLE_EQ(of_leader[0].of_leader.at(0.3), 0.7);
  const std::vector<JointFollower> of_affine = FollowersOf(m.get(), std::vector<int>{1});
  ASSERT_THAT(of_affine, SizeIs(2));
  EXPECT_EQ(of_affine[0].joint, 0);
  EXPECT_NEAR(of_affine[0].of_leader.at(0.7), 0.3, 1e-15);
  EXPECT_NEAR(of_affine[1].of_leader.at(0.7), 0.3 + 0.5 * 0.09, 1e-15);
  EXPECT_THAT(FollowersOf(m.get(), std::vector<int>{2}), IsEmpty()) << "it bends";
  EXPECT_THAT(FollowersOf(m.get(), std::vector<int>{3}), IsEmpty());
}

TEST(JointFollowers, AmongAListAreLedByTheirLeaderOrTheFirst) {
  const ModelPtr m = FollowersModel();
  const std::vector<ListedFollower> with_leader =
      FollowersAmong(m.get(), std::vector<int>{2, 0, 3});
  ASSERT_THAT(with_leader, SizeIs(1));
  EXPECT_EQ(with_leader[0].index, 0U);
  EXPECT_EQ(with_leader[0].leader, 1U);
  const std::vector<ListedFollower> without = FollowersAmong(m.get(), std::vector<int>{1, 2});
  ASSERT_THAT(without, SizeIs(1));
  EXPECT_EQ(without[0].index, 1U);
  EXPECT_EQ(without[0].leader, 0U);
}

TEST(JointFollowers, LeaveThePartOfARangeInWhichTheyKeepTheirOwn) {
  const JointPolynomial down{0, {0.5, -2, 0, 0, 0}}, bends{0, {0, 1, 0, 1, 0}};
  const JointRange affine = RangeWithin(down, {-1, 1}, {-0.5, 1.5});
  EXPECT_DOUBLE_EQ(affine.lower, -0.5);
  EXPECT_DOUBLE_EQ(affine.upper, 0.5);
  const JointRange open = RangeWithin(down, {-kNoEnd, kNoEnd}, {-0.5, kNoEnd});
  EXPECT_EQ(open.lower, -kNoEnd);
  EXPECT_DOUBLE_EQ(open.upper, 0.5);
  const JointRange bent = RangeWithin(bends, {-2, 2}, {-2, 10});
  EXPECT_NEAR(bent.lower, -1, 1e-12);
  EXPECT_NEAR(bent.upper, 2, 1e-12);
  const JointRange none = RangeWithin(down, {-1, 1}, {3, 4});
  EXPECT_GT(none.lower, none.upper);
}

TEST(JointFollowers, MustNotTurnBack) {
  const JointPolynomial square{0.5, {0, 0, 1, 0, 0}};
  EXPECT_TRUE(IsMonotone(square, {0.5, 2}));
  EXPECT_FALSE(IsMonotone(square, {0, 2}));
}

}  // namespace
}  // namespace robocell::internal
