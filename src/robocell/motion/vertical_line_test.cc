#include "robocell/motion/vertical_line.h"

#include <gtest/gtest.h>

#include "robocell/testing/pick_scene.h"

namespace robocell::internal {
namespace {

TEST(VerticalLine, KeepsTheOrientationAndRisesEvenly) {
  const PickScene pick = MakePickScene(ObjectOnTheTable("box"));
  const Chain& chain = pick.robot.chain();
  const JointVector q = pick.home();
  const Pose tcp = chain.Fk(q);
  const double height = 0.06;
  const JointPath line = LineAbove(chain, tcp, q, Eigen::Vector3d::UnitZ(), height);
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
  const JointPath line =
      LineAbove(chain, chain.Fk(q), q, Eigen::Vector3d::UnitZ(), 2 * pick.robot.reach());
  EXPECT_LT(line.size(), kLinePoints + 1u);
  EXPECT_GT(MissingShare(line), 0);
}

}  // namespace
}  // namespace robocell::internal
