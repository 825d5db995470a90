// Tests that base inertial parameters do not change the dynamics of the joints.
#include "robocell/kinematics/base_inertial_parameters.h"

#include <gtest/gtest.h>

#include "robocell/kinematics/link_kernel.h"
#include "robocell/kinematics/testing/models.h"

namespace robocell::internal {

namespace {

ChainModel RandomChain(Rng* rng, int joints, double slide_share) {
  const RandomChainOptions options{.joints = joints, .slide_share = slide_share};
  const TestModel t = TestModel::FromXml(RandomChainXml(rng, options).Write());
  return Chain(t.model(), "base", ChainTip::Site("tip")).model();
}

std::vector<double> Torques(const LinkTable& table, LinkPart part, const LinkQuery& query) {
  LinkAnswer answer;
  ComputeLinks(table, part, query, &answer);
  return {answer.torques, answer.torques + table.n};
}
std::vector<double> Masses(const LinkTable& table, const LinkQuery& query) {
  LinkAnswer answer;
  ComputeLinks(table, LinkPart::kMass, query, &answer);
  std::vector<double> masses;
  for (int i = 0; i < table.n; ++i)
    masses.insert(masses.end(), answer.mass[i], answer.mass[i] + table.n);
  return masses;
}

void ExpectNear(const std::vector<double>& got, const std::vector<double>& expected) {
  for (size_t k = 0; k < expected.size(); ++k) EXPECT_NEAR(got[k], expected[k], 1e-11) << k;
}

TEST(BaseInertialParameters, PreservesMassesAndTorques) {
  Rng rng = Rng::Stream(1, "base inertial parameters");
  for (int k = 0; k < 30; ++k) {
    const ChainModel chain = RandomChain(&rng, 1 + k % 10, 0.1 * (k % 4));
    const LinkTable links = Tabulate(chain), felt = Tabulate(WithBaseInertialParameters(chain));
    double q[kMaxChainJoints], qd[kMaxChainJoints], qdd[kMaxChainJoints], gravity[3];
    for (double* values : {q, qd, qdd})
      std::generate_n(values, chain.n, [&] { return rng.Normal(); });
    std::generate_n(gravity, 3, [&] { return 5 * rng.Normal(); });
    const LinkQuery query{.q = q, .qd = qd, .qdd = qdd, .gravity = gravity};
    ExpectNear(Masses(felt, query), Masses(links, query));
    for (const LinkPart part : {LinkPart::kGravity, LinkPart::kMotion})
      ExpectNear(Torques(felt, part, query), Torques(links, part, query));
    ASSERT_FALSE(HasFailure()) << chain.n << " joints";
  }
}

TEST(BaseInertialParameters, OfAHingedLinkHaveNoIsotropicPart) {
  Rng rng = Rng::Stream(2, "base inertial parameters");
  const ChainModel plain = RandomChain(&rng, 12, 0.3);
  const ChainModel chain = WithBaseInertialParameters(plain);
  for (int i = 0; i < chain.n; ++i) {
    const LinkInertia& link = chain.joints[i].link;
    if (chain.joints[i].slide) {  // keeps its own and gets those of hinges beyond
      EXPECT_GE(link.mass, plain.joints[i].link.mass) << i;
      continue;
    }
    EXPECT_EQ(link.mass, 0) << i;
    EXPECT_EQ(link.weight_mass, 0) << i;
    EXPECT_EQ(link.moment.z(), 0) << i;
    EXPECT_EQ(link.weight_moment.z(), 0) << i;
    EXPECT_EQ(link.inertia(1, 1), 0) << i;
  }
}

}  // namespace
}  // namespace robocell::internal
