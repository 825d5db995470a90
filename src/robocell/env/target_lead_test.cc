// Tests, as laws of random poses, what is taken back of a target that leads the arm.
#include "robocell/env/target_lead.h"

#include <gtest/gtest.h>

#include <cmath>

#include "robocell/base/rng.h"
#include "robocell/env/arm_target.h"
#include "robocell/math/rotation.h"
#include "robocell/testing/random_values.h"

namespace robocell::internal {
namespace {

using Eigen::Vector3d;

constexpr StepLimit kLead{0.02, 0.1};

// An arm that stays where it is.
Led<Pose> Still(const Pose& arm) { return {arm, arm, arm, arm}; }
Led<double> StillAt(double joint) { return {joint, joint, joint, joint}; }

double Length(const std::array<double, 3>& x) { return std::hypot(x[0], x[1], x[2]); }

double Distance(const Pose& a, const Pose& b) { return (a.translation() - b.translation()).norm(); }

TEST(TargetLead, ATargetWithinTheLeadIsKeptAndPending) {
  Rng rng = Rng::Stream(1, "target lead");
  for (int trial = 0; trial < 100; ++trial) {
    const Pose arm = RandomPose(rng);
    const Pose sent = MovedBy(arm, Pose::FromRpy({0.011, 0.009, -0.01}, {0.05, 0.01, -0.05}));
    PendingMove pending;
    AddMove(pending, arm, sent);
    EXPECT_TRUE(WithinLead(sent, Still(arm), kLead, pending) == sent);
    EXPECT_NEAR(Length(pending.shift), Distance(arm, sent), 1e-12);
    EXPECT_NEAR(Length(pending.turn), AngleBetween(arm.quaternion(), sent.quaternion()), 1e-6);
    EXPECT_TRUE(WithinLead(sent, Still(sent), kLead, pending) == sent) << "it was carried out";
    EXPECT_NEAR(Length(pending.shift) + Length(pending.turn), 0, 1e-12);
  }
}

TEST(TargetLead, TakesBackTheTargetOfABlockedArmToTheLead) {
  Rng rng = Rng::Stream(2, "target lead");
  for (int trial = 0; trial < 100; ++trial) {
    const Pose arm = RandomPose(rng);
    const Pose move(0.3 * RandomVector(rng, 1).normalized());
    const Pose sent = MovedBy(arm, move);
    PendingMove pending;
    AddMove(pending, arm, sent);
    const Pose last = WithinLead(sent, Still(arm), kLead, pending);
    EXPECT_NEAR(Distance(last, arm), kLead.translation, 1e-9);
    EXPECT_NEAR(Distance(last, sent), 0.3 - kLead.translation, 1e-9) << "along the move";
    EXPECT_LT(AngleBetween(last.quaternion(), sent.quaternion()), 1e-6);
    EXPECT_NEAR(std::hypot(pending.shift[0], pending.shift[1], pending.shift[2]), kLead.translation,
                1e-9);

    const Pose turn = Pose::FromRotvec(Vector3d::Zero(), 0.4 * RandomVector(rng, 1).normalized());
    const Pose turned = MovedBy(arm, turn);
    PendingMove pending_turn;
    AddMove(pending_turn, arm, turned);
    const Pose back = WithinLead(turned, Still(arm), kLead, pending_turn);
    EXPECT_NEAR(AngleBetween(back.quaternion(), arm.quaternion()), kLead.rotation, 1e-6);
  }
}

TEST(TargetLead, AnOpposingActionReducesTheLead) {
  Rng rng = Rng::Stream(5, "target lead");
  for (int trial = 0; trial < 100; ++trial) {
    const Pose arm = RandomPose(rng);
    const Vector3d direction = RandomVector(rng, 1).normalized();
    const Pose sent = MovedBy(arm, Pose(0.3 * direction));
    const Vector3d along = (sent.translation() - arm.translation()).normalized();
    for (const double back : {0.0, 0.001, 0.015, 0.05}) {
      PendingMove pending, action;
      AddMove(pending, arm, sent);
      Eigen::Map<Vector3d>(action.shift.data()) = -back * along;
      const Pose last = WithinLead(sent, Still(arm), kLead, pending, action);
      EXPECT_NEAR(Distance(last, arm), std::max(0.0, kLead.translation - back), 1e-9) << back;
    }
    const Vector3d aside = along.cross(RandomVector(rng, 1)).normalized();
    for (const Vector3d& other : {Vector3d(0.05 * along), Vector3d(0.05 * aside)}) {
      PendingMove pending, action;
      AddMove(pending, arm, sent);
      Eigen::Map<Vector3d>(action.shift.data()) = other;
      EXPECT_NEAR(Distance(WithinLead(sent, Still(arm), kLead, pending, action), arm),
                  kLead.translation, 1e-9);
    }
    double joint = 0.5;
    EXPECT_NEAR(WithinJointLead(0.5, StillAt(0), 0.1, joint, -0.04), 0.06, 1e-12);
    joint = -0.5;
    EXPECT_NEAR(WithinJointLead(-0.5, StillAt(0), 0.1, joint, 0.3), 0, 1e-12);
    joint = 0.5;
    EXPECT_NEAR(WithinJointLead(0.5, StillAt(0), 0.1, joint, 0.3), 0.1, 1e-12);
  }
}

TEST(TargetLead, KeepsATargetWithoutPendingMotion) {
  Rng rng = Rng::Stream(3, "target lead");
  for (int trial = 0; trial < 100; ++trial) {
    const Pose sent = RandomPose(rng);
    const Pose arm = MovedBy(sent, Pose::FromRpy(RandomVector(rng, 0.3), {0.3, 0.2, 0.1}));
    PendingMove none;
    EXPECT_TRUE(WithinLead(sent, Still(arm), kLead, none) == sent);
    PendingMove away;  // a move that brought the target nearer to the arm
    AddMove(away, Pose(2 * sent.translation() - arm.translation(), sent.quaternion()), sent);
    EXPECT_TRUE(WithinLead(sent, Still(arm), kLead, away).is_close(sent, 1e-12, 1e-12));
  }
}

TEST(TargetLead, TreatsTheServoLagAsPartOfTheArm) {
  const Pose arm = Pose(), sent(Vector3d(0, 0, -0.3)), beyond(Vector3d(0, 0, -0.4));
  PendingMove pending;
  AddMove(pending, arm, sent);
  PendingMove same = pending;
  EXPECT_TRUE(WithinLead(sent, {arm, arm, arm, beyond}, kLead, pending) == sent);
  EXPECT_NEAR(Length(pending.shift), 0.3, 1e-12) << "it is not carried out yet";
  EXPECT_TRUE(WithinLead(sent, {arm, arm, sent, sent}, kLead, same) == sent);
  EXPECT_EQ(Length(same.shift), 0) << "it sags";
}

TEST(TargetLead, TreatsADisturbanceAsPending) {
  const Pose sent(Vector3d(0, 0, -0.1)), before(Vector3d(0, 0, -0.05)), arm(Vector3d(0.1, 0, 0));
  PendingMove pending = {.shift = {0, 0, -0.02}};
  const Pose last = WithinLead(sent, {before, arm, arm, arm}, kLead, pending);
  EXPECT_NEAR(last.translation().z(), -0.03, 1e-12) << "0.02 and 0.05 are pending";
  EXPECT_EQ(last.translation().x(), 0) << "it was not sent aside";
  double joint = 0.2;
  EXPECT_NEAR(WithinJointLead(1, {0.6, 0.3, 0.3, 0.3}, 0.1, joint), 0.5, 1e-12);
}

TEST(TargetLead, HandlesJointsLikePoses) {
  double pending = 0.5;
  EXPECT_NEAR(WithinJointLead(0.5, StillAt(0), 0.1, pending), 0.1, 1e-12);
  EXPECT_NEAR(pending, 0.1, 1e-12);
  pending = -0.2;
  EXPECT_NEAR(WithinJointLead(-0.5, StillAt(0), 0.1, pending), -0.3, 1e-12)
      << "no more than is pending";
  EXPECT_NEAR(pending, 0, 1e-12);
  pending = -0.2;
  EXPECT_EQ(WithinJointLead(0.5, StillAt(0), 0.1, pending), 0.5) << "it came nearer";
  pending = 0.2;
  EXPECT_EQ(WithinJointLead(0.5, {0.45, 0.45, 0, 0}, 0.1, pending), 0.5);
  EXPECT_NEAR(pending, 0.05, 1e-12);
}

TEST(TargetLead, TakesBackJointsOfAPoseTogether) {
  Rng rng = Rng::Stream(6, "target lead");
  for (int trial = 0; trial < 200; ++trial) {
    constexpr size_t kJoints = 5;
    std::vector<double> sent(kJoints), pending(kJoints), leads(kJoints);
    std::vector<Led<double>> led;
    double over = 0;  // the largest share of a lead
    for (size_t i = 0; i < kJoints; ++i) {
      const double at = rng.Uniform(-1, 1);
      led.push_back(StillAt(at));
      pending[i] = rng.Uniform(-1, 1);
      sent[i] = at + pending[i];
      leads[i] = rng.Uniform(0.1, 1);
      over = std::max(over, std::abs(pending[i]) / leads[i]);
    }
    std::vector<double> bounded = sent, left = pending;
    EXPECT_EQ(TakeBackJoints(bounded, led, leads, left), over > 1);
    for (size_t i = 0; i < kJoints; ++i) {
      EXPECT_NEAR(bounded[i] - led[i].present, pending[i] / std::max(1.0, over), 1e-12);
      EXPECT_NEAR(left[i], bounded[i] - led[i].present, 1e-12);
    }
  }
}

TEST(TargetLead, KeepsJointsThatLagSagOrWereNotCommanded) {
  const std::vector<double> leads = {0.1, 0.1, 0.1};
  std::vector<double> sent = {1, 1, 1}, pending = {1, 1, 0};
  const std::vector<Led<double>> led = {{0, 0, 0, 1}, {0, 0, 1, 1}, StillAt(0)};
  EXPECT_FALSE(TakeBackJoints(sent, led, leads, pending));
  EXPECT_EQ(sent, std::vector<double>(3, 1));
  EXPECT_EQ(pending, (std::vector<double>{1, 0, 0})) << "what lags is not carried out yet";
}

// Whatever commands an arm receives while it lags behind its target: where a wall stops it, its
// target is ahead by the lead and one action, and is as far back as an action sends it from there.
TEST(TargetLead, LimitsTheLeadOfAnArmStoppedInMotion) {
  Rng rng = Rng::Stream(4, "target lead");
  for (int trial = 0; trial < 300; ++trial) {
    const double lag = rng.Uniform(0, 8), action = rng.Uniform(0.001, 0.05);
    const double wall = rng.Uniform(0.1, 0.5), lead = kLead.translation;
    const Vector3d direction = RandomVector(rng, 1).normalized();
    Pose sent, arm;
    PendingMove pending;
    double target = 0, joint = 0, pending_joint = 0, v = 0;
    int last_moves = 0;
    for (int step = 0; step < 2000 && last_moves < 3; ++step) {
      // The time of an action is the unit of time: an arm at speed v lags by v times lag.
      const double next = std::min(wall, joint + v);
      const bool stopped = next == wall;
      if (stopped) ++last_moves;
      const double steady = next + (stopped ? 0 : v * lag);
      const auto at = [&](double x) { return Pose(x * direction); };
      sent = WithinLead(sent, {at(joint), at(next), at(next), at(steady)}, kLead, pending);
      target = WithinJointLead(target, {joint, next, next, steady}, lead, pending_joint);
      joint = next;
      const Pose to(sent.translation() + action * direction);
      AddMove(pending, sent, to);
      pending_joint += action;
      sent = to;
      target += action;
      v = (target - joint) / (lag + 1);
    }
    ASSERT_EQ(last_moves, 3);
    EXPECT_LE(target - wall, lead + action + 1e-9) << lag << " " << action;
    EXPECT_LE(sent.translation().dot(direction) - wall, lead + action + 1e-9)
        << lag << " " << action;
  }
}

}  // namespace
}  // namespace robocell::internal
