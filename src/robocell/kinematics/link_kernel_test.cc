// Tests each part of the kernel by itself against the engine, for chains that fill registers and
// chains that leave lanes empty.
#include "robocell/kinematics/link_kernel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <Eigen/Core>

#include "robocell/base/rng.h"
#include "robocell/kinematics/chain.h"
#include "robocell/kinematics/link_answer.h"
#include "robocell/kinematics/testing/engine_says.h"
#include "robocell/kinematics/testing/models.h"

namespace robocell::internal {
namespace {

// A random chain in a random state, its query, and the engine's values.
struct Query {
  Query(Rng* rng, int joints)
      : model(TestModel::FromXml(RandomChainXml(rng, {.joints = joints}).Write())) {
    model.Randomise(rng);
    chain.emplace(ChainAsItStands(model, "base", ChainTip::Site("tip")));
    q = model.ChainPositions(*chain);
    qd = qdd = JointVector(joints);
    for (double& v : qd) v = rng->Normal();
    for (double& a : qdd) a = rng->Normal();
    gravity = GravityInBase(model, *chain);
  }
  // Fills the answer with NaN first: a part must write all of its numbers.
  LinkAnswer Compute(LinkPart part, bool accelerates = true) const {
    LinkAnswer out;
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (auto& row : out.tip) std::fill_n(row, 4, nan);
    for (auto& row : out.jacobian) std::fill_n(row, kMaxChainJoints, nan);
    for (auto& row : out.mass) std::fill_n(row, kMaxChainJoints, nan);
    std::fill_n(out.torques, kMaxChainJoints, nan);
    ComputeLinks(chain->links(), part,
                 {.q = q.data(),
                  .qd = qd.data(),
                  .qdd = accelerates ? qdd.data() : nullptr,
                  .gravity = gravity.data()},
                 &out);
    return out;
  }
  void ExpectTip(const LinkAnswer& out) const {
    const Transform tip = TipOf(out), expected = model.TipInBase(*chain);
    EXPECT_LT((tip.translation - expected.translation).norm(), 1e-12);
    EXPECT_LT((tip.rotation - expected.rotation).norm(), 1e-12);
  }
  void ExpectJacobian(const LinkAnswer& out) const {
    const Eigen::MatrixXd expected = EngineJacobian(model, *chain);
    for (int r = 0; r < 6; ++r) {
      for (int i = 0; i < chain->n_joints(); ++i)
        EXPECT_NEAR(out.jacobian[r][i], expected(r, i), 1e-12) << r << " " << i;
    }
  }
  // kAll has the lower triangle alone.
  void ExpectMass(const LinkAnswer& out, bool lower_only) const {
    const Eigen::MatrixXd expected = EngineMassMatrix(model, *chain);
    for (int i = 0; i < chain->n_joints(); ++i) {
      for (int j = 0; j < (lower_only ? i + 1 : chain->n_joints()); ++j)
        EXPECT_NEAR(out.mass[i][j], expected(i, j), 1e-10) << i << " " << j;
    }
  }
  void ExpectTorques(const LinkAnswer& out, const Eigen::VectorXd& expected) const {
    for (int i = 0; i < chain->n_joints(); ++i) EXPECT_NEAR(out.torques[i], expected[i], 1e-9) << i;
  }

  TestModel model;
  std::optional<Chain> chain;
  JointVector q, qd, qdd;
  Eigen::Vector3d gravity;
};

// 3, 4 and 5 joints lie around a register of four lanes, 7, 8 and 9 around one of eight.
TEST(LinkKernel, EachPartIsThatOfTheEngine) {
  for (const int joints : {1, 3, 4, 5, 7, 8, 9, kMaxChainJoints}) {
    for (int k = 0; k < 3; ++k) {
      Rng rng = Rng::Stream(k, "link kernel", joints);
      const Query query(&rng, joints);
      query.ExpectTip(query.Compute(LinkPart::kTip));
      const LinkAnswer jacobian = query.Compute(LinkPart::kJacobian);
      query.ExpectTip(jacobian);
      query.ExpectJacobian(jacobian);
      query.ExpectMass(query.Compute(LinkPart::kMass), /*lower_only=*/false);
      // The following calls change the velocities of the engine's data.
      query.ExpectTorques(query.Compute(LinkPart::kGravity),
                          EngineGravityTorques(query.model, *query.chain));
      query.ExpectTorques(query.Compute(LinkPart::kMotion),
                          EngineInverseDynamics(query.model, *query.chain, query.qd, query.qdd));
      const LinkAnswer all = query.Compute(LinkPart::kAll);
      query.ExpectTip(all);
      query.ExpectJacobian(all);
      query.ExpectMass(all, /*lower_only=*/true);
      query.ExpectTorques(all,
                          EngineInverseDynamics(query.model, *query.chain, query.qd, query.qdd));
      if (HasFailure()) FAIL() << joints << " joints, chain " << k;
    }
  }
}

TEST(LinkKernel, WithoutAccelerationsTheTorquesAreThoseOfAccelerationZero) {
  Rng rng = Rng::Stream(0, "link kernel at rest");
  const Query query(&rng, 7);
  query.ExpectTorques(query.Compute(LinkPart::kMotion, /*accelerates=*/false),
                      EngineInverseDynamics(query.model, *query.chain, query.qd, JointVector(7)));
}

}  // namespace
}  // namespace robocell::internal
