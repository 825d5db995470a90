#include "robocell/motion/vertical_line.h"

#include <gtest/gtest.h>

#include "robocell/base/rng.h"
#include "robocell/kinematics/testing/models.h"
#include "robocell/testing/pick_scene.h"

namespace robocell::internal {
namespace {

TEST(VerticalLine, KeepsTheOrientationAndRisesEvenly) {
  const PickScene pick = MakePickScene(ObjectOnTheTable("box"));
  const Chain& chain = pick.robot.chain();
  const JointVector q = pick.home();
  const Pose tcp = chain.Fk(q);
  const double height = 0.06;
  const JointPath line =
      LineAbove(chain, TaskSpaceOf(pick.robot), tcp, q, Eigen::Vector3d::UnitZ(), height);
  ASSERT_EQ(line.size(), kLinePoints + 1u);
  EXPECT_EQ(MissingShare(line), 0);
  for (size_t i = 0; i < line.size(); ++i) {
    const Pose at = chain.Fk(line[i]);
    const double risen = height * static_cast<double>(i) / kLinePoints;
    EXPECT_TRUE(at.is_close(
        {tcp.translation() + risen * Eigen::Vector3d::UnitZ(), tcp.quaternion()}, 1e-3, 1e-3))
        << i;
  }
}

TEST(VerticalLine, EndsAtTheLimitOfTheArm) {
  const PickScene pick = MakePickScene(ObjectOnTheTable("box"));
  const JointVector q = pick.home();
  const Chain& chain = pick.robot.chain();
  const JointPath line = LineAbove(chain, TaskSpaceOf(pick.robot), chain.Fk(q), q,
                                   Eigen::Vector3d::UnitZ(), 2 * pick.robot.reach());
  EXPECT_LT(line.size(), kLinePoints + 1u);
  EXPECT_GT(MissingShare(line), 0);
}

// Arms of five joints hardly ever keep the rotation. Their task space decides whether it may differ.
TEST(VerticalLine, TheTaskSpaceDecidesHowFarTheHandMayTilt) {
  Rng rng = Rng::Stream(1, "lines of few joints");
  const TaskSpace whole({.kind = TaskSpaceKind::kPose}), axis({.kind = TaskSpaceKind::kAxis}), free;
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  size_t points = 0, points_whole = 0, points_axis = 0;
  for (int trial = 0; trial < 30; ++trial) {
    const TestModel model =
        TestModel::FromXml(RandomChainXml(&rng, {.joints = 5, .limited_share = 1}).Write());
    const Chain chain(model.model(), "base", ChainTip::Site("tip"));
    JointVector q(chain.n_joints());
    for (int i = 0; i < q.size(); ++i) {
      const ChainJoint& joint = chain.joints()[i];
      q[i] = joint.lower + rng.Uniform(0.3, 0.7) * (joint.upper - joint.lower);
    }
    const Pose tcp = chain.Fk(q);
    const auto line = [&](const TaskSpace& task, double tilt) {
      const JointPath path = LineAbove(chain, task, tcp, q, up, 0.04);
      for (size_t k = 1; k < path.size(); ++k) {
        const Pose at = chain.Fk(path[k]);
        const Eigen::Vector3d wanted =
            tcp.translation() + 0.04 * static_cast<double>(k) / kLinePoints * up;
        EXPECT_LT((at.translation() - wanted).norm(), 1.1e-4) << trial;
        EXPECT_LE(AngleBetween(at.quaternion(), tcp.quaternion()), tilt) << trial;
      }
      return path.size() - 1;
    };
    points_whole += line(whole, 1.1e-4);
    points += line(free, kMostTilt);
    points_axis += line(axis, kMostTilt);
  }
  EXPECT_GT(points, 2 * points_whole);
  EXPECT_GT(points_axis, 2 * points_whole);
}

}  // namespace
}  // namespace robocell::internal
