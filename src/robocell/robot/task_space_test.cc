// Tests the part of a pose that counts for an arm: laws of the nearest pose, and inverse kinematics.
#include "robocell/robot/task_space.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "robocell/base/rng.h"
#include "robocell/kinematics/testing/models.h"
#include "robocell/math/rotation.h"

namespace robocell::internal {
namespace {

Pose RandomPose(Rng& rng, double size) {
  return {
      Eigen::Vector3d(rng.Uniform(-size, size), rng.Uniform(-size, size), rng.Uniform(-size, size)),
      RandomQuaternion(rng)};
}

double AngleOfAxes(const Pose& a, const Pose& b, const Eigen::Vector3d& axis) {
  const Eigen::Vector3d u = Rotate(a.quaternion(), axis), v = Rotate(b.quaternion(), axis);
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

TEST(TaskSpace, TheNearestPoseAgreesWithTheTargetWhereItCounts) {
  Rng rng = Rng::Stream(1, "task space");
  for (int trial = 0; trial < 200; ++trial) {
    const Pose target = RandomPose(rng, 1), tip = RandomPose(rng, 1);
    const Pose any = TaskSpace({.kind = TaskSpaceKind::kPosition}).Nearest(target, tip);
    EXPECT_EQ(any.translation(), target.translation());
    EXPECT_LT(AngleBetween(any.quaternion(), tip.quaternion()), 1e-9);

    const Vec3 axis = {rng.Uniform(-1, 1), rng.Uniform(-1, 1), rng.Uniform(-1, 1)};
    const Eigen::Vector3d unit = ToEigen(axis).normalized();
    const double cone = trial % 2 ? rng.Uniform(0, 1) : 0;
    const TaskSpace swings({.kind = TaskSpaceKind::kAxis, .axis = axis, .cone = cone});
    const Pose near = swings.Nearest(target, tip);
    const double before = AngleOfAxes(target, tip, unit);
    EXPECT_EQ(near.translation(), target.translation());
    EXPECT_NEAR(AngleOfAxes(near, target, unit), std::min(cone, before), 1e-7);
    EXPECT_NEAR(AngleBetween(near.quaternion(), tip.quaternion()), std::max(before - cone, 0.0),
                1e-7)
        << "no rotation is smaller";
    EXPECT_LT(AngleBetween(swings.Nearest(target, near).quaternion(), near.quaternion()), 1e-6);

    const TaskSpace floats({.position_weights = Vec3{1, 0, 1}});
    const Eigen::Vector3d rest =
        Rotate(QuaternionInverse(target.quaternion()),
               floats.Nearest(target, tip).translation() - target.translation());
    EXPECT_NEAR(rest.x(), 0, 1e-9);
    EXPECT_NEAR(rest.z(), 0, 1e-9);
    EXPECT_EQ(TaskSpace().Nearest(target, tip).translation(), target.translation());
  }
}

// The oracle is forward kinematics: what counts of the solution's pose is the target's.
TEST(TaskSpace, StepsReachWhatCountsAndStayNear) {
  Rng rng = Rng::Stream(2, "task space steps");
  for (const bool whole_axis : {false, true}) {
    const TaskSpace task = whole_axis ? TaskSpace({.kind = TaskSpaceKind::kAxis})
                                      : TaskSpace({.kind = TaskSpaceKind::kPosition});
    int reached = 0, tried = 0;
    for (int trial = 0; trial < 40; ++trial) {
      const TestModel model = TestModel::FromXml(
          RandomChainXml(&rng, {.joints = 5 + trial % 3, .slide_share = 0.1, .limited_share = 1})
              .Write());
      const Chain chain(model.model(), "base", ChainTip::Site("tip"));
      JointVector from(chain.n_joints());
      for (int i = 0; i < from.size(); ++i) {
        const ChainJoint& joint = chain.joints()[i];
        from[i] = joint.lower + rng.Uniform(0.3, 0.7) * (joint.upper - joint.lower);
      }
      const Pose tip = chain.Fk(from);
      const Pose target(tip.translation() + RandomPose(rng, 4e-3).translation(),
                        whole_axis ? tip.quaternion() : RandomQuaternion(rng));
      const IkResult found = task.Step(chain, target, from);
      ++tried;
      if (!found.success) continue;
      ++reached;
      const Pose got = chain.Fk(found.q);
      EXPECT_LE((got.translation() - target.translation()).norm(), 1e-5);
      if (whole_axis) {
        EXPECT_LE(AngleOfAxes(got, target, Eigen::Vector3d::UnitZ()), 1e-5);
      }
    }
    EXPECT_GE(reached, tried * 9 / 10);
  }
}

TEST(TaskSpace, FewJointsReachThePositionUnlessAPoseIsConfigured) {
  Rng rng = Rng::Stream(3, "few joints");
  const TestModel model = TestModel::FromXml(RandomChainXml(&rng, {.joints = 5}).Write());
  const Chain chain(model.model(), "base", ChainTip::Site("tip"));
  EXPECT_TRUE(TaskSpace().reaches_position_first(chain));
  EXPECT_FALSE(TaskSpace({.kind = TaskSpaceKind::kPose}).reaches_position_first(chain));
  EXPECT_EQ(TaskSpace().text(), "");
  EXPECT_EQ(TaskSpace({.kind = TaskSpaceKind::kPosition}).text(), "the position alone");
}

}  // namespace
}  // namespace robocell::internal
