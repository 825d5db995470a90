#include "robocell/kinematics/link_answer.h"

#include <gtest/gtest.h>

#include "robocell/kinematics/testing/coupled_chains.h"
#include "robocell/kinematics/testing/ik_judge.h"

namespace robocell::internal {
namespace {

// Controllers ask for everything at once.
TEST(LinkAnswer, HasAllPartsOfAChainWithFollowers) {
  for (int k = 0; k < 20; ++k) {
    Rng rng = Rng::Stream(8, "link answer", k);
    const TestModel t = TestModel::FromXml(CoupledChainXml(&rng, 3 + k % 7));
    const Chain chain(t.model(), "base", ChainTip::Site("tip"));
    const int n = chain.n_joints();
    const JointVector q = RandomJoints(chain, &rng), still(n);
    JointVector qd(n), torques(n);
    for (double& v : qd) v = rng.Normal();
    const Eigen::Vector3d gravity(1, -2, -9);
    LinkAnswer all;
    ComputeChain(chain, LinkPart::kAll, {.q = q.data(), .qd = qd.data(), .gravity = gravity.data()},
                 &all);
    Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian(6, n);
    Eigen::MatrixXd mass(n, n);
    const Pose tip = chain.Jacobian(q, jacobian);
    chain.MassMatrix(q, mass);
    chain.InverseDynamics(q, qd, still, gravity, torques);
    EXPECT_LT((TipOf(all).translation - tip.translation()).norm(), 1e-12);
    for (int i = 0; i < n; ++i) {
      for (int r = 0; r < 6; ++r) EXPECT_NEAR(all.jacobian[r][i], jacobian(r, i), 1e-12);
      for (int j = 0; j < n; ++j) EXPECT_NEAR(all.mass[j][i], mass(j, i), 1e-11);
      EXPECT_NEAR(all.torques[i], torques[i], 1e-10);
    }
  }
}

}  // namespace
}  // namespace robocell::internal
