// Tests batches against the engine, finite differences and the chain's own functions, on every
// instruction set; no result depends on its neighbours.
#include "robocell/kinematics/chain_batch.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "robocell/kinematics/testing/engine_says.h"
#include "robocell/testing/decompositions.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/instruction_sets.h"

namespace robocell {
namespace {

using namespace std::string_literals;

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using MatrixMap = Eigen::Map<const Matrix>;

// All results of a batch.
struct Results {
  std::vector<double> tips, jacobians, gravity, masses, motion, coriolis, manipulability;

  bool operator==(const Results&) const = default;
};

struct Motions {
  std::vector<double> q, qd, qdd, gravity;
  int count = 0;

  void Add(const JointVector& at, const JointVector& v, const JointVector& a,
           const Eigen::Vector3d& g) {
    q.insert(q.end(), at.begin(), at.end());
    qd.insert(qd.end(), v.begin(), v.end());
    qdd.insert(qdd.end(), a.begin(), a.end());
    gravity.insert(gravity.end(), g.begin(), g.end());
    ++count;
  }
};

Results Compute(const Chain& chain, const Motions& m, int count) {
  const size_t n = chain.n_joints(), b = count;
  Results r{std::vector<double>(b * 16), std::vector<double>(b * 6 * n),
            std::vector<double>(b * n),  std::vector<double>(b * n * n),
            std::vector<double>(b * n),  std::vector<double>(b * n),
            std::vector<double>(b)};
  FkBatch(chain, m.q, r.tips);
  JacobianBatch(chain, m.q, r.jacobians);
  GravityTorquesBatch(chain, m.q, m.gravity, r.gravity);
  MassMatrixBatch(chain, m.q, r.masses);
  InverseDynamicsBatch(chain, m.q, m.qd, m.qdd, m.gravity, r.motion);
  CoriolisTorquesBatch(chain, m.q, m.qd, r.coriolis);
  ManipulabilityBatch(chain, m.q, r.manipulability);
  return r;
}

// Returns the volume of the twists for joint speeds of unit norm: the product of the Jacobian's
// singular values.
double VolumeOf(const Matrix& jacobian) { return SvdOf(jacobian).values.prod(); }

JointVector RandomRates(Rng* rng, int n) {
  JointVector rates(n);
  for (double& rate : rates) rate = rng->Normal();
  return rates;
}

// The engine's results, one pose after the other.
struct EngineBatch {
  Motions motions;
  std::vector<Transform> tips;
  std::vector<Matrix> jacobians, masses;
  std::vector<Eigen::VectorXd> gravity, motion, coriolis;

  EngineBatch(TestModel& t, const Chain& chain, Rng* rng, int count) {
    for (int k = 0; k < count; ++k) {
      for (int i = 0; i < chain.n_joints(); ++i) {
        const ChainJoint& joint = chain.joints()[i];
        t.data()->qpos[joint.qpos_address] =
            rng->Uniform(std::max(joint.lower, -3.0), std::min(joint.upper, 3.0));
      }
      t.Forward();
      const JointVector qd = RandomRates(rng, chain.n_joints());
      const JointVector qdd = RandomRates(rng, chain.n_joints());
      motions.Add(t.ChainPositions(chain), qd, qdd, GravityInBase(t, chain));
      tips.push_back(t.TipInBase(chain));
      jacobians.push_back(EngineJacobian(t, chain));
      gravity.push_back(EngineGravityTorques(t, chain));
      masses.push_back(EngineMassMatrix(t, chain));
      motion.push_back(EngineInverseDynamics(t, chain, qd, qdd));
      coriolis.push_back(EngineInverseDynamics(t, chain, qd, JointVector(chain.n_joints())) -
                         gravity.back());
    }
  }

  void ExpectSame(const Chain& chain, const Results& r) const {
    const int n = chain.n_joints();
    for (int k = 0; k < motions.count; ++k) {
      const MatrixMap tip(r.tips.data() + 16 * k, 4, 4);
      EXPECT_LT((tip.topLeftCorner(3, 3) - tips[k].rotation).norm(), 1e-12);
      EXPECT_LT((tip.topRightCorner(3, 1) - tips[k].translation).norm(), 1e-12);
      EXPECT_EQ(tip.bottomRows(1), Eigen::RowVector4d(0, 0, 0, 1));
      const MatrixMap jacobian(r.jacobians.data() + 6 * n * k, 6, n);
      EXPECT_LT((jacobian - jacobians[k]).norm(), 1e-11);
      const MatrixMap mass(r.masses.data() + n * n * k, n, n);
      EXPECT_LT((mass - masses[k]).norm(), 1e-10);
      EXPECT_LT((MatrixMap(r.gravity.data() + n * k, n, 1) - gravity[k]).norm(), 1e-10);
      EXPECT_LT((MatrixMap(r.motion.data() + n * k, n, 1) - motion[k]).norm(), 1e-9);
      EXPECT_LT((MatrixMap(r.coriolis.data() + n * k, n, 1) - coriolis[k]).norm(), 1e-9);
      const double volume = VolumeOf(jacobians[k]);
      EXPECT_NEAR(std::pow(r.manipulability[k], 2), volume * volume, 1e-11 * (1 + volume * volume));
    }
  }
};

class MenagerieBatch : public testing::TestWithParam<MenagerieArm> {};
INSTANTIATE_TEST_SUITE_P(Arms, MenagerieBatch, testing::ValuesIn(MenagerieArms()), ArmName);

TEST_P(MenagerieBatch, AgreesWithTheEngineOnTiltedMounts) {
  REQUIRE_MENAGERIE(GetParam().folder);
  TestModel t = TestModel::FromFile(MenagerieModel(GetParam().folder, GetParam().file));
  Rng rng = Rng::Stream(1, "chain batch", GetParam().folder);
  t.Displace(GetParam().base, &rng);
  const Chain chain = ChainAsItStands(t, GetParam().base, GetParam().tip);
  const EngineBatch engine(t, chain, &rng, 21);
  OnEveryInstructionSet([&](const std::string&) {
    engine.ExpectSame(chain, Compute(chain, engine.motions, engine.motions.count));
  });
}

void ExpectWhatTheEngineSays(Rng* rng, const RandomChainOptions& options) {
  TestModel t = TestModel::FromXml(RandomChainXml(rng, options).Write());
  t.Randomise(rng);
  const Chain chain = ChainAsItStands(t, "base", ChainTip::Site("tip"));
  const EngineBatch engine(t, chain, rng, 11);
  OnEveryInstructionSet([&](const std::string&) {
    engine.ExpectSame(chain, Compute(chain, engine.motions, engine.motions.count));
  });
  ASSERT_FALSE(testing::Test::HasFailure()) << options.joints << " joints";
}

TEST(ChainBatch, AgreesWithTheEngineOnRandomChains) {
  for (int joints = 1; joints <= 16; ++joints) {
    Rng rng = Rng::Stream(2, "chain batch", joints);
    ExpectWhatTheEngineSays(&rng, {.joints = joints});
  }
}

TEST(ChainBatch, AgreesWithTheEngineWhereAxesAreParallelOrSquare) {
  for (int joints = 1; joints <= 9; ++joints) {
    for (const double slides : {0.0, 0.3}) {
      for (int draw = 0; draw < 3; ++draw) {
        Rng rng = Rng::Stream(3, "chain batch", 10 * joints + draw);
        ExpectWhatTheEngineSays(&rng, {.joints = joints, .slide_share = slides, .square = true});
      }
    }
  }
}

// Hinges whose deviation from parallel is too small to appear in the cosine.
TEST(ChainBatch, AgreesWithTheEngineWhereAxesAreNearlyParallel) {
  for (const double twist : {1e-9, 1e-8, 1e-6, 1e-3}) {
    std::string bodies;
    for (int i = 0; i < 4; ++i) {
      bodies += fmt::format(
          "<body pos='0.1 0.2 0.3' quat='1 0 {:.17g} 0'><joint name='j{}' axis='0 0 1'/>"
          "<geom size='0.1' pos='0.1 0 0' contype='0' conaffinity='0'/>",
          i == 0 ? 0 : twist / 2, i);
    }
    bodies += "<site name='tip' pos='0.3 0 0.4'/>" + "</body></body></body></body>"s;
    TestModel t = TestModel::FromXml("<mujoco><worldbody><body name='base'>" + bodies +
                                     "</body></worldbody></mujoco>");
    Rng rng = Rng::Stream(4, "chain batch");
    const Chain chain = ChainAsItStands(t, "base", ChainTip::Site("tip"));
    const EngineBatch engine(t, chain, &rng, 11);
    OnEveryInstructionSet([&](const std::string&) {
      engine.ExpectSame(chain, Compute(chain, engine.motions, engine.motions.count));
    });
    ASSERT_FALSE(HasFailure()) << twist;
  }
}

struct RandomCase {
  Rng rng;
  TestModel model;
  Chain chain;
  Motions motions;

  explicit RandomCase(int joints, int count) : RandomCase({.joints = joints}, count) {}
  RandomCase(const RandomChainOptions& options, int count)
      : rng(Rng::Stream(options.joints, "batch case")),
        model(TestModel::FromXml(RandomChainXml(&rng, options).Write())),
        chain(model.model(), "base", ChainTip::Site("tip")) {
    for (int k = 0; k < count; ++k) {
      model.Randomise(&rng);
      const Eigen::Vector3d gravity(rng.Normal(), rng.Normal(), -9);
      motions.Add(model.ChainPositions(chain), RandomRates(&rng, options.joints),
                  RandomRates(&rng, options.joints), gravity);
    }
  }
};

// Returns chains of all kinds that kernels distinguish.
std::vector<RandomChainOptions> Chains() {
  std::vector<RandomChainOptions> chains;
  for (const int joints : {2, 6, 7, 10}) {
    chains.push_back({.joints = joints});
    chains.push_back({.joints = joints, .slide_share = 0, .square = true});
  }
  return chains;
}

TEST(ChainBatch, JacobiansMatchFiniteDifferences) {
  RandomCase c(7, 1);
  const double h = 1e-6;
  Motions around;
  for (int i = 0; i < 7; ++i) {
    for (const double side : {-h, h}) {
      JointVector q{std::span<const double>(c.motions.q)};
      q[i] += side;
      around.Add(q, q, q, Eigen::Vector3d::Zero());
    }
  }
  std::vector<double> tips(16 * around.count), jacobian(42);
  FkBatch(c.chain, around.q, tips);
  JacobianBatch(c.chain, c.motions.q, jacobian);
  for (int i = 0; i < 7; ++i) {
    const Pose before = Pose::FromMatrix(MatrixMap(tips.data() + 32 * i, 4, 4));
    const Pose after = Pose::FromMatrix(MatrixMap(tips.data() + 32 * i + 16, 4, 4));
    const Eigen::Matrix<double, 6, 1> slope = PoseDifference(before, after) / (2 * h);
    EXPECT_LT((slope - MatrixMap(jacobian.data(), 6, 7).col(i)).norm(), 1e-7) << i;
  }
}

TEST(ChainBatch, JacobiansIncludeThePosesOfForwardKinematics) {
  OnEveryInstructionSet([](const std::string&) {
    for (const RandomChainOptions& options : Chains()) {
      const RandomCase c(options, 19);
      const Results expected = Compute(c.chain, c.motions, 19);
      std::vector<double> jacobians(expected.jacobians.size()), tips(expected.tips.size());
      JacobianBatch(c.chain, c.motions.q, jacobians, tips);
      EXPECT_EQ(jacobians, expected.jacobians);
      EXPECT_EQ(tips, expected.tips);
    }
  });
}

// Compares bit for bit: whole, one by one, and shifted by some lanes.
TEST(ChainBatch, ResultsDoNotDependOnTheBatch) {
  OnEveryInstructionSet([](const std::string&) {
    for (const RandomChainOptions& options : Chains()) {
      const RandomCase c(options, 19);
      const int joints = options.joints;
      const Results whole = Compute(c.chain, c.motions, 19);
      for (const int first : {0, 1, 5, 18}) {
        for (const int count : {1, 3, 19 - first}) {
          if (first + count > 19) continue;
          Motions part;
          part.count = count;
          const auto cut = [&](const std::vector<double>& all, size_t row) {
            return std::vector<double>(all.begin() + row * first,
                                       all.begin() + row * (first + count));
          };
          part.q = cut(c.motions.q, joints);
          part.qd = cut(c.motions.qd, joints);
          part.qdd = cut(c.motions.qdd, joints);
          part.gravity = cut(c.motions.gravity, 3);
          const size_t n = joints;
          const Results expected{cut(whole.tips, 16),         cut(whole.jacobians, 6 * n),
                                 cut(whole.gravity, n),       cut(whole.masses, n * n),
                                 cut(whole.motion, n),        cut(whole.coriolis, n),
                                 cut(whole.manipulability, 1)};
          EXPECT_EQ(Compute(c.chain, part, count), expected) << first << " " << count;
        }
      }
    }
  });
}

TEST(ChainBatch, OneRowMatchesTheBatch) {
  const RandomCase c(7, 5);
  std::vector<double> torques(35), expected(35);
  const std::span<const double> qd = std::span(c.motions.qd).first(7);
  const std::vector<double> gravity = {1, 2, -9};
  InverseDynamicsBatch(c.chain, c.motions.q, qd, c.motions.qdd, gravity, torques);
  std::vector<double> all_qd, all_gravity;
  for (int k = 0; k < 5; ++k) {
    all_qd.insert(all_qd.end(), qd.begin(), qd.end());
    all_gravity.insert(all_gravity.end(), gravity.begin(), gravity.end());
  }
  InverseDynamicsBatch(c.chain, c.motions.q, all_qd, c.motions.qdd, all_gravity, expected);
  EXPECT_EQ(torques, expected);
  std::vector<double> none;
  MassMatrixBatch(c.chain, none, none);
}

TEST(ChainBatch, NamesTheInvalidArgument) {
  RandomCase c(7, 4);
  std::vector<double> out(28);
  const std::vector<double> gravity = {0, 0, -9.81};
  const auto torques = [&] { GravityTorquesBatch(c.chain, c.motions.q, gravity, out); };
  c.motions.q[16] = NAN;
  ExpectThrow<ArgumentError>(torques,
                             "chain 'base' -> site 'tip': q[2]: joint 'j2' is nan; joint values "
                             "must be finite");
  c.motions.q.pop_back();
  ExpectThrow<ArgumentError>(torques,
                             "chain 'base' -> site 'tip': q: expected 7 numbers, or 7 for each of "
                             "4 configurations; got 27");
  out.pop_back();
  ExpectThrow<ArgumentError>(torques, "the output has 27 numbers, not whole rows of 7");
  std::vector<double> jacobians(28 / 7 * 42), tips(63);
  ExpectThrow<ArgumentError>(
      [&] { JacobianBatch(c.chain, std::vector<double>(28), jacobians, tips); },
      "chain 'base' -> site 'tip': tips: expected 16 numbers for each of 4 configurations; got 63");
  const std::vector<double> no_gravity = {0, 0, INFINITY};
  out.resize(7);
  const std::vector<double> q(7);
  ExpectThrow<ArgumentError>([&] { GravityTorquesBatch(c.chain, q, no_gravity, out); },
                             "gravity has numbers that are not finite");
}

}  // namespace
}  // namespace robocell
