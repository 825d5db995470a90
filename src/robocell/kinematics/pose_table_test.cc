// Tests which chains are plain; the test of the kernel that reads the table's numbers
// (chain_batch_test.cc) covers their effect.
#include "robocell/kinematics/pose_table.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/kinematics/testing/models.h"

namespace robocell::internal {
namespace {

// Three hinges, each about an axis of the previous one, the last one turned further.
ChainModel ThreeHinges(const Eigen::Vector3d& second, const Eigen::Vector3d& third) {
  ChainModel chain;
  chain.n = 3;
  const auto to = [](const Eigen::Vector3d& axis) {
    double q[4];
    mju_quatZ2Vec(q, axis.data());
    return Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
  };
  chain.joints[1].fixed = {to(second), Eigen::Vector3d(0.1, 0.2, 0.3)};
  chain.joints[2].fixed = {to(third), Eigen::Vector3d(0.3, -0.2, 0.1)};
  return chain;
}

bool IsPlain(const ChainModel& chain) { return TabulatePoses(chain).plain; }

TEST(PoseTable, IsPlainForHingesWhoseAxesAreParallelOrSquare) {
  const Eigen::Vector3d x(1, 0, 0), z(0, 0, 1), tilted(0.6, 0, 0.8);
  EXPECT_TRUE(IsPlain(ThreeHinges(x, z)));
  EXPECT_TRUE(IsPlain(ThreeHinges(z, -x)));
  EXPECT_FALSE(IsPlain(ThreeHinges(x, tilted)));
  EXPECT_FALSE(IsPlain(ThreeHinges(-z, x))) << "antiparallel";
  for (const int slide : {0, 1, 2}) {
    ChainModel chain = ThreeHinges(x, z);
    chain.joints[slide].slide = true;
    EXPECT_FALSE(IsPlain(chain)) << slide;
  }
}

// Their frames stay unchanged (normal_frames.h), and the cosine of such a twist may be 1.
TEST(PoseTable, KeepsTinyTwists) {
  for (const double twist : {1e-13, 1e-9, 1e-8, 1e-3}) {
    ChainModel chain = ThreeHinges({0, 0, 1}, {1, 0, 0});
    chain.joints[1].fixed.rotation =
        Eigen::AngleAxisd(twist, Eigen::Vector3d::UnitX()).toRotationMatrix();
    EXPECT_FALSE(IsPlain(chain)) << twist;
    EXPECT_EQ(TabulatePoses(chain).joints[1].twist, PoseJoint::Twist::kAboutX) << twist;
  }
}

TEST(PoseTable, IsPlainForRandomChainsOfSuchHinges) {
  for (int joints = 1; joints <= 9; ++joints) {
    Rng rng = Rng::Stream(joints, "pose table");
    const RandomChainOptions options{.joints = joints, .slide_share = 0, .square = true};
    const TestModel t = TestModel::FromXml(RandomChainXml(&rng, options).Write());
    EXPECT_TRUE(IsPlain(Chain(t.model(), "base", ChainTip::Site("tip")).model())) << joints;
  }
}

}  // namespace
}  // namespace robocell::internal
