// What is taken back of a target that leads the arm, as laws of random poses.
#include "robocell/env/target_lead.h"

#include <gtest/gtest.h>

#include <cmath>

#include "robocell/base/rng.h"
#include "robocell/env/arm_target.h"
#include "robocell/math/rotation.h"
#include "robocell/testing/random_values.h"

namespace robocell {
namespace {

using Eigen::Vector3d;

constexpr StepLimit kLead{0.02, 0.1};

double Distance(const Pose& a, const Pose& b) { return (a.translation() - b.translation()).norm(); }

TEST(TargetLead, ATargetWithinTheLeadIsKeptAndNothingIsPending) {
  Rng rng = Rng::Stream(1, "target lead");
  for (int trial = 0; trial < 100; ++trial) {
    const Pose arm = RandomPose(rng);
    const Pose sent = MovedBy(arm, Pose::FromRpy({0.011, 0.009, -0.01}, {0.05, 0.01, -0.05}));
    PendingMove pending;
    pending.Add(arm, sent);
    EXPECT_TRUE(WithinLead(sent, arm, arm, kLead, pending) == sent);
    EXPECT_EQ(pending.shift, (std::array<double, 3>{}));
    EXPECT_EQ(pending.turn, (std::array<double, 3>{}));
  }
}

TEST(TargetLead, WhatABlockedArmDidNotCarryOutIsTakenBackToTheLead) {
  Rng rng = Rng::Stream(2, "target lead");
  for (int trial = 0; trial < 100; ++trial) {
    const Pose arm = RandomPose(rng);
    const Pose move(0.3 * RandomVector(rng, 1).normalized());
    const Pose sent = MovedBy(arm, move);
    PendingMove pending;
    pending.Add(arm, sent);
    const Pose last = WithinLead(sent, arm, arm, kLead, pending);
    EXPECT_NEAR(Distance(last, arm), kLead.translation, 1e-9);
    EXPECT_NEAR(Distance(last, sent), 0.3 - kLead.translation, 1e-9) << "along the move";
    EXPECT_LT(AngleBetween(last.quaternion(), sent.quaternion()), 1e-6);
    EXPECT_NEAR(std::hypot(pending.shift[0], pending.shift[1], pending.shift[2]), kLead.translation,
                1e-9);

    const Pose turn = Pose::FromRotvec(Vector3d::Zero(), 0.4 * RandomVector(rng, 1).normalized());
    const Pose turned = MovedBy(arm, turn);
    PendingMove pending_turn;
    pending_turn.Add(arm, turned);
    const Pose back = WithinLead(turned, arm, arm, kLead, pending_turn);
    EXPECT_NEAR(AngleBetween(back.quaternion(), arm.quaternion()), kLead.rotation, 1e-6);
  }
}

TEST(TargetLead, WhatIsNotPendingIsKept) {
  Rng rng = Rng::Stream(3, "target lead");
  for (int trial = 0; trial < 100; ++trial) {
    const Pose sent = RandomPose(rng);
    const Pose arm = MovedBy(sent, Pose::FromRpy(RandomVector(rng, 0.3), {0.3, 0.2, 0.1}));
    PendingMove none;
    EXPECT_TRUE(WithinLead(sent, arm, arm, kLead, none) == sent);
    PendingMove away;  // a move that brought the target nearer to the arm
    away.Add(Pose(2 * sent.translation() - arm.translation(), sent.quaternion()), sent);
    EXPECT_TRUE(WithinLead(sent, arm, arm, kLead, away).is_close(sent, 1e-12, 1e-12));
  }
}

TEST(TargetLead, TheArmCountsAsWhereItIsNearer) {
  const Pose arm = Pose(), sent(Vector3d(0, 0, -0.3));
  PendingMove pending;
  pending.Add(arm, sent);
  PendingMove same = pending;
  EXPECT_TRUE(WithinLead(sent, sent, arm, kLead, pending) == sent);
  EXPECT_TRUE(WithinLead(sent, arm, sent, kLead, same) == sent);
}

TEST(TargetLead, JointsAreAsPoses) {
  double pending = 0.5;
  EXPECT_NEAR(WithinJointLead(0.5, 0, 0, 0.1, pending), 0.1, 1e-12);
  EXPECT_NEAR(pending, 0.1, 1e-12);
  pending = -0.2;
  EXPECT_NEAR(WithinJointLead(-0.5, 0, 0, 0.1, pending), -0.3, 1e-12) << "no more than is pending";
  EXPECT_NEAR(pending, 0, 1e-12);
  pending = -0.2;
  EXPECT_EQ(WithinJointLead(0.5, 0, 0, 0.1, pending), 0.5) << "it came nearer";
  pending = 0.2;
  EXPECT_EQ(WithinJointLead(0.5, 0, 0.45, 0.1, pending), 0.5);
  EXPECT_EQ(pending, 0);
}

}  // namespace
}  // namespace robocell
