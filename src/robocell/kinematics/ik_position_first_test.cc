// Tests arms of fewer than six joints: they reach positions, with the nearest rotation.
#include "robocell/kinematics/ik_position_first.h"

#include <gtest/gtest.h>

#include <cmath>

#include "robocell/base/error.h"
#include "robocell/kinematics/testing/models.h"
#include "robocell/math/rotation.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

Chain RandomChain(Rng& rng, int joints, std::optional<TestModel>* model) {
  model->emplace(TestModel::FromXml(
      RandomChainXml(&rng, {.joints = joints, .slide_share = 0.1, .limited_share = 1}).Write()));
  return Chain((*model)->model(), "base", ChainTip::Site("tip"));
}

JointVector Inside(const Chain& chain, Rng& rng) {
  JointVector q(chain.n_joints());
  for (int i = 0; i < q.size(); ++i) {
    const ChainJoint& joint = chain.joints()[i];
    q[i] = joint.lower + rng.Uniform(0.25, 0.75) * (joint.upper - joint.lower);
  }
  return q;
}

// Targets a few millimetres away, with the rotation of the start.
TEST(IkPositionFirst, ReachesThePositionAndStaysNear) {
  Rng rng = Rng::Stream(5, "position first");
  int reached = 0, tried = 0;
  for (int trial = 0; trial < 60; ++trial) {
    std::optional<TestModel> model;
    const Chain chain = RandomChain(rng, 4 + trial % 2, &model);
    const JointVector from = Inside(chain, rng);
    const Pose tip = chain.Fk(from);
    const Eigen::Vector3d offset(rng.Uniform(-4e-3, 4e-3), rng.Uniform(-4e-3, 4e-3),
                                 rng.Uniform(-4e-3, 4e-3));
    const Pose target(tip.translation() + offset, tip.quaternion());
    const IkResult found = IkPositionFirst(chain, target, from);
    ++tried;
    const Pose got = chain.Fk(found.q);
    EXPECT_NEAR(found.position_error, (got.translation() - target.translation()).norm(), 1e-12);
    EXPECT_NEAR(found.rotation_error, AngleBetween(got.quaternion(), target.quaternion()), 1e-9);
    if (!found.success) continue;  // a singular place
    ++reached;
    EXPECT_LE(found.position_error, 1e-5);
    for (int i = 0; i < chain.n_joints(); ++i) {
      EXPECT_GE(found.q[i], chain.joints()[i].lower);
      EXPECT_LE(found.q[i], chain.joints()[i].upper);
    }
  }
  EXPECT_GE(reached, tried * 9 / 10);
}

// No neighbour that reaches the position has a nearer rotation. The oracle moves one joint and
// solves for the position again.
TEST(IkPositionFirst, TheRotationIsTheNearest) {
  Rng rng = Rng::Stream(6, "nearest rotation");
  int compared = 0;
  for (int trial = 0; trial < 20; ++trial) {
    std::optional<TestModel> model;
    const Chain chain = RandomChain(rng, 5, &model);
    const JointVector from = Inside(chain, rng);
    const Pose tip = chain.Fk(from);
    const Pose target = Pose::FromRotvec(tip.translation(), {0.02, -0.03, 0.02});
    const Pose turned(tip.translation(), QuaternionProduct(target.quaternion(), tip.quaternion()));
    const IkResult found = IkPositionFirst(chain, turned, from);
    if (!found.success) continue;
    for (int i = 0; i < chain.n_joints(); ++i) {
      for (const double aside : {-0.01, 0.01}) {
        IkOptions options{.seed = found.q, .position_only = true, .max_restarts = 0};
        options.seed[i] += aside;
        options.locked[static_cast<size_t>(i)] = true;
        const IkResult other = Ik(chain, turned, options);
        if (!other.success) continue;
        ++compared;
        EXPECT_GE(AngleBetween(chain.Fk(other.q).quaternion(), turned.quaternion()),
                  found.rotation_error - 1e-5)
            << "trial " << trial << ", joint " << i;
      }
    }
  }
  EXPECT_GT(compared, 50);
}

TEST(IkPositionFirst, APoseThatCanBeReachedIsReached) {
  Rng rng = Rng::Stream(7, "whole pose");
  for (int trial = 0; trial < 20; ++trial) {
    std::optional<TestModel> model;
    const Chain chain = RandomChain(rng, 5, &model);
    const JointVector from = Inside(chain, rng);
    JointVector goal = from;
    for (int i = 0; i < goal.size(); ++i) goal[i] += rng.Uniform(-0.02, 0.02);
    const IkResult found = IkPositionFirst(chain, chain.Fk(goal), from);
    ASSERT_TRUE(found.success) << trial;
    EXPECT_LE(found.rotation_error, 1e-4) << trial;
  }
}

TEST(IkPositionFirst, FailsForAPositionOutOfReach) {
  Rng rng = Rng::Stream(8, "out of reach");
  std::optional<TestModel> model;
  const Chain chain = RandomChain(rng, 4, &model);
  EXPECT_FALSE(
      IkPositionFirst(chain, Pose({50, 0, 0}, Quaternion{0, 0, 0, 1}), Inside(chain, rng)).success);
}

TEST(IkPositionFirst, IsForFewJointsOnly) {
  Rng rng = Rng::Stream(9, "six joints");
  std::optional<TestModel> model;
  const Chain chain = RandomChain(rng, 6, &model);
  EXPECT_FALSE(HasFewJoints(chain));
  const JointVector q = Inside(chain, rng);
  ExpectThrow<ArgumentError>([&] { IkPositionFirst(chain, chain.Fk(q), q); },
                             "position first is for fewer than six joints");
}

}  // namespace
}  // namespace robocell::internal
