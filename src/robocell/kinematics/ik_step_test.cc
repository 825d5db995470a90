// Tests damped steps towards a pose: they come nearer, never farther, and no joint swings.

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "robocell/kinematics/ik_step.h"
#include "robocell/kinematics/testing/models.h"
#include "robocell/math/rotation.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

constexpr const char* kStraightArm = R"(<mujoco><compiler angle="radian"/>
  <worldbody><body name="base"><geom size=".1"/>
    <body><joint name="a" axis="0 1 0" range="-2 2"/><geom size=".05"/>
      <body pos=".3 0 0"><joint name="b" axis="0 1 0" range="-2 2"/><geom size=".05"/>
        <body pos=".3 0 0"><joint name="c" axis="0 1 0" range="-2 2"/><geom size=".05"/>
          <site name="tip" pos=".1 0 0"/></body></body></body></body></worldbody></mujoco>)";

// The step from `tip` to `target`: its length in rad, with lengths weighed as what is commanded.
struct StepError {
  Pose tip, target;

  double operator()(const Chain& chain, std::span<const double> q) const {
    const Pose now = chain.Fk(q);
    return std::hypot(
        (target.translation() - now.translation()).norm() / LengthPerRadian(chain, tip, target),
        robocell::AngleBetween(target.quaternion(), now.quaternion()));
  }
};

TEST(LengthPerRadian, IsTheCommandedRatioWithinLimitsOfTheChainLength) {
  const TestModel model = TestModel::FromXml(kStraightArm);
  const Chain chain(model.model(), "base", ChainTip::Site("tip"));
  const double length = chain.model().length;
  const auto of = [&](double metres, double radians) {
    return LengthPerRadian(chain, Pose(), Pose::FromRotvec({metres, 0, 0}, {0, radians, 0}));
  };
  EXPECT_NEAR(of(0.5 * length, 1), 0.5 * length, 1e-12);
  EXPECT_NEAR(of(0, 1), 0.02 * length, 1e-12);
  EXPECT_NEAR(of(0.1 * length, 0.01), length, 1e-12);
  EXPECT_EQ(of(0.01, 0), length);
}

TEST(IkTowards, ApproachesWithoutSwingingAJoint) {
  Rng rng = Rng::Stream(3, "ik towards");
  for (int trial = 0; trial < 50; ++trial) {
    const TestModel model = TestModel::FromXml(
        RandomChainXml(&rng, {.joints = 3 + trial % 5, .slide_share = 0.1, .limited_share = 1})
            .Write());
    const Chain chain(model.model(), "base", ChainTip::Site("tip"));
    JointVector from(chain.n_joints());
    for (int i = 0; i < from.size(); ++i) {
      const ChainJoint& joint = chain.joints()[i];
      from[i] = joint.lower + rng.Uniform(0.1, 0.9) * (joint.upper - joint.lower);
    }
    const Pose tip = chain.Fk(from);
    const Pose target = tip * Pose::FromRpy({rng.Uniform(-.05, .05), 0.02, 0}, {0, 0.1, 0});
    const IkResult near = IkTowards(chain, target, from);
    const StepError error{tip, target};
    const double before = error(chain, from), after = error(chain, near.q);
    EXPECT_LE(after, before);
    EXPECT_EQ(near.success, after <= 0.98 * before);
    EXPECT_NEAR(near.position_error, (target.translation() - chain.Fk(near.q).translation()).norm(),
                1e-12);
    const double most = LargestJointStep(chain, tip, target) * std::max(1.0, chain.model().length);
    for (int i = 0; i < from.size(); ++i) {
      EXPECT_LE(std::abs(near.q[i] - from[i]), most + 1e-9);
      EXPECT_GE(near.q[i], chain.joints()[i].lower - 1e-9);
      EXPECT_LE(near.q[i], chain.joints()[i].upper + 1e-9);
    }
  }
}

TEST(IkTowards, BendsAStretchedArmExceptOutwards) {
  const TestModel model = TestModel::FromXml(kStraightArm);
  const Chain chain(model.model(), "base", ChainTip::Site("tip"));
  const JointVector straight(3);
  const Pose tip = chain.Fk(straight);
  const auto moved = [&](double x) {
    return Pose(tip.translation() + Eigen::Vector3d(x, 0, 0), tip.quaternion());
  };
  const IkResult in = IkTowards(chain, moved(-0.02), straight);
  EXPECT_TRUE(in.success);
  EXPECT_LT(chain.Fk(in.q).translation().x(), tip.translation().x() - 1e-3);
  const IkResult out = IkTowards(chain, moved(0.02), straight);
  EXPECT_FALSE(out.success);
  EXPECT_NEAR(out.position_error, 0.02, 1e-3);
}

// The elbow of a stretched arm bends to the side where it has room, and an arm that stands at the
// limit of the other side comes back: each step of a long way in is possible.
TEST(IkTowards, BendsTowardsTheFartherLimit) {
  for (const char* range : {"-0.1 2", "-2 0.1", "0 2", "-2 0"}) {
    std::string xml = kStraightArm;
    const std::string old = R"(name="b" axis="0 1 0" range="-2 2")";
    xml.replace(xml.find(old), old.size(),
                std::string(R"(name="b" axis="0 1 0" range=")") + range + '"');
    const TestModel model = TestModel::FromXml(xml);
    const Chain chain(model.model(), "base", ChainTip::Site("tip"));
    const double lower = chain.joints()[1].lower, upper = chain.joints()[1].upper;
    const double near_end = std::abs(lower) < std::abs(upper) ? lower : upper;
    for (const double elbow : {0.0, near_end}) {
      JointVector q(3);
      q[1] = elbow;
      const Pose start = chain.Fk(q);
      for (int step = 1; step <= 15; ++step) {
        const Pose target(start.translation() - Eigen::Vector3d(0.01 * step, 0, 0),
                          start.quaternion());
        const IkResult next = IkTowards(chain, target, q);
        ASSERT_TRUE(next.success) << range << ", elbow at " << elbow << ", step " << step;
        q = next.q;
      }
      EXPECT_LT(chain.Fk(q).translation().x(), start.translation().x() - 0.12)
          << range << ", elbow at " << elbow;
    }
  }
}

// At the wrist's singular place the tip cannot turn about one axis at once: it stays, and turns as
// far as the arm can make it.
TEST(IkTowards, APureRotationKeepsTheTipPosition) {
  const TestModel model = TestModel::FromXml(R"(<mujoco><compiler angle="radian"/>
    <worldbody><body name="base"><geom size=".1"/>
      <body pos="0 0 .3"><joint name="a" axis="0 0 1" range="-3 3"/><geom size=".05"/>
        <body><joint name="b" axis="0 1 0" range="-2 2"/><geom size=".05"/>
          <body pos="0 0 .4"><joint name="c" axis="0 1 0" range="-2 2"/><geom size=".05"/>
            <body pos="0 0 .3"><joint name="d" axis="0 0 1" range="-3 3"/><geom size=".05"/>
              <body><joint name="e" axis="0 1 0" range="-2 2"/><geom size=".05"/>
                <body><joint name="f" axis="0 0 1" range="-3 3"/><geom size=".05"/>
                  <site name="tip" pos="0 0 .1"/>
    </body></body></body></body></body></body></body></worldbody></mujoco>)");
  const Chain chain(model.model(), "base", ChainTip::Site("tip"));
  for (const double angle : {0.01, 0.05, -0.05}) {
    for (const Eigen::Vector3d axis : {Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitX()}) {
      JointVector q(std::vector<double>{0, 0.3, 0.9, 0, 0, 0});
      const Pose first = chain.Fk(q);
      const Eigen::Vector3d start = first.translation();
      for (int step = 0; step < 20; ++step) {
        const Pose tip = chain.Fk(q);
        const Pose turn = Pose::FromRotvec({0, 0, 0}, angle * axis);
        const Pose target(tip.translation(),
                          (turn * Pose({0, 0, 0}, tip.quaternion())).quaternion());
        IkResult next = IkStep(chain, target, q);
        if (!next.success) next = IkTowards(chain, target, q);
        if (next.success) q = next.q;
        ASSERT_LT((chain.Fk(q).translation() - start).norm(), 0.002)
            << angle << " about " << axis.transpose() << ", step " << step;
      }
      EXPECT_GT(robocell::AngleBetween(first.quaternion(), chain.Fk(q).quaternion()),
                0.5 * 20 * std::abs(angle))
          << angle << " about " << axis.transpose();
    }
  }
}

TEST(IkTowards, RejectsValuesThatAreNotFinite) {
  const TestModel model = TestModel::FromXml(kStraightArm);
  const Chain chain(model.model(), "base", ChainTip::Site("tip"));
  ExpectThrow<ArgumentError>(
      [&] {
        (void)IkTowards(chain, Pose(), std::vector<double>{0, NAN, 0});
      },
      "inverse kinematics towards a pose: joint 'b' is nan; joint values must be finite");
}

}  // namespace
}  // namespace robocell::internal
