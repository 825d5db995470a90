// Tests properties of every query of every chain, alone and in batches: random chains of 1 to 12
// joints with slides, tiny limits, limits of a turn and more, and without limits; queries of every
// kind. The judge is the engine.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "robocell/kinematics/ik_batch.h"
#include "robocell/kinematics/manipulability.h"
#include "robocell/kinematics/testing/ik_judge.h"

namespace robocell {
namespace {

constexpr double kTolerance = 1e-5;
constexpr int kMostRestarts = 40, kMostIterations = 30;

struct ManyQueries {
  std::vector<Pose> targets;
  std::vector<double> seeds;  // row by row
  std::vector<bool> reachable;
  std::vector<std::string> kinds;

  int size() const { return static_cast<int>(targets.size()); }
  std::span<const double> seed(int b) const {
    const std::size_t n = seeds.size() / targets.size();
    return std::span(seeds).subspan(b * n, n);
  }
};

enum class Sort { kPlain, kWithSlides, kTinyLimits, kLocked, kWholeTurns };

class IkProperties : public testing::TestWithParam<std::tuple<int, Sort>> {
 protected:
  IkProperties()
      : rng_(Rng::Stream(std::get<0>(GetParam()), "ik properties",
                         static_cast<int>(std::get<1>(GetParam())))),
        model_(TestModel::FromXml(RandomChainXml(&rng_, Options()).Write())),
        chain_(model_.model(), "base", ChainTip::Site("tip")) {
    if (std::get<1>(GetParam()) != Sort::kLocked) return;
    for (int i = 0; i < chain_.n_joints(); ++i) options_.locked[i] = rng_.Uniform() < 0.3;
  }

  static RandomChainOptions Options() {
    const auto [joints, sort] = GetParam();
    return {.joints = joints,
            .slide_share = sort == Sort::kPlain ? 0 : 0.35,
            .tiny_share = sort == Sort::kTinyLimits ? 0.4 : 0,
            .whole_turn_share = sort == Sort::kWholeTurns ? 0.7 : 0};
  }

  void Add(const Pose& target, const JointVector& truth, const std::string& kind, bool reachable) {
    queries_.targets.push_back(target);
    queries_.reachable.push_back(reachable);
    queries_.kinds.push_back(kind);
    // Starts near the solution, anywhere in the limits, far beyond them.
    const double away = queries_.size() % 3 == 0 ? 0.05 : queries_.size() % 3 == 1 ? 1 : 20;
    for (int i = 0; i < truth.size(); ++i) {
      const double off = options_.locked[i] ? 0 : rng_.Uniform(-away, away);
      queries_.seeds.push_back(truth[i] + off);
    }
  }
  JointVector AtLimits() {
    JointVector q = RandomJoints(chain_, &rng_);
    for (int i = 0; i < q.size(); ++i) {
      const ChainJoint& joint = chain_.joints()[i];
      if (joint.limited && rng_.Uniform() < 0.6)
        q[i] = rng_.Uniform() < 0.5 ? joint.lower : joint.upper;
    }
    return q;
  }
  // Takes the worst of many.
  JointVector NearlySingular() {
    JointVector worst = RandomJoints(chain_, &rng_);
    for (int k = 0; k < 100; ++k) {
      const JointVector q = RandomJoints(chain_, &rng_);
      if (Manipulability(chain_, q) < Manipulability(chain_, worst)) worst = q;
    }
    return worst;
  }
  void MakeQueries() {
    for (int k = 0; k < 8; ++k) {
      for (const auto& [kind, q] :
           {std::pair{"anywhere", RandomJoints(chain_, &rng_)}, std::pair{"at limits", AtLimits()},
            std::pair{"nearly singular", NearlySingular()}})
        Add(chain_.Fk(q), q, kind, true);
      const JointVector q = RandomJoints(chain_, &rng_);
      const Eigen::Vector3d away(rng_.Normal(), rng_.Normal(), rng_.Normal());
      Add(Pose(std::pow(30.0, k) * away), q, "out of reach", false);
      Add(Pose::FromRpy(0.5 * away, {away.y(), away.z(), away.x()}), q, "anything", false);
    }
  }

  // Checks everything that a result claims.
  void Check(int b, std::span<const double> q, bool success, double position_error,
             double rotation_error, int iterations) {
    const std::string what = fmt::format("query {}, {}", b, queries_.kinds[b]);
    for (int i = 0; i < chain_.n_joints(); ++i) {
      const ChainJoint& joint = chain_.joints()[i];
      if (options_.locked[i]) {
        EXPECT_EQ(q[i], queries_.seed(b)[i]) << what << ", locked joint " << i;
      } else {
        EXPECT_TRUE(q[i] >= joint.lower && q[i] <= joint.upper) << what << ", joint " << i;
      }
    }
    const Pose& target = queries_.targets[b];
    EXPECT_EQ(success, position_error <= kTolerance && rotation_error <= kTolerance) << what;
    if (success) {
      EXPECT_TRUE(EngineAgrees(model_, chain_, target, q, 1.0001 * kTolerance)) << what;
    }
    const Pose reached = chain_.Fk(q);
    const double off = (reached.translation() - target.translation()).stableNorm();
    EXPECT_NEAR(position_error, off, 1e-9 * (1 + off)) << what;
    EXPECT_NEAR(rotation_error, (target.inverse() * reached).angle(), 1e-6) << what;
    EXPECT_LE(iterations, (kMostRestarts + 1) * (kMostIterations + 1)) << what;
  }

  Rng rng_;
  TestModel model_;
  Chain chain_;
  IkOptions options_{
      .tolerance = kTolerance, .max_restarts = kMostRestarts, .max_iterations = kMostIterations};
  ManyQueries queries_;
};
INSTANTIATE_TEST_SUITE_P(Joints, IkProperties,
                         testing::Combine(testing::Range(1, 13),
                                          testing::Values(Sort::kPlain, Sort::kWithSlides,
                                                          Sort::kTinyLimits, Sort::kLocked,
                                                          Sort::kWholeTurns)));

TEST_P(IkProperties, HoldForAllKindsOfQueries) {
  MakeQueries();
  const IkBatchResult batch = IkBatch(chain_, queries_.targets, queries_.seeds, {.ik = options_});
  int reachable = 0, solved = 0, singles = 0;
  for (int b = 0; b < batch.size; ++b) {
    Check(b, batch.row(b), batch.success[b], batch.position_error[b], batch.rotation_error[b],
          batch.iterations[b]);
    IkOptions single = options_;
    single.seed = JointVector(queries_.seed(b));
    const IkResult one = Ik(chain_, queries_.targets[b], single);
    Check(b, one.q, one.success, one.position_error, one.rotation_error, one.iterations);
    if (!queries_.reachable[b]) continue;
    ++reachable;
    solved += batch.success[b];
    singles += one.success;
  }
  EXPECT_GE(solved, reachable - 1);
  EXPECT_GE(singles, reachable - 1);
}

// To the bit: alone, among any others, in any order, on any number of threads.
TEST_P(IkProperties, SolutionsDependOnlyOnTheirQueries) {
  MakeQueries();
  const int size = queries_.size();
  const auto ask = [&](const std::vector<int>& which, int threads) {
    std::vector<Pose> targets;
    std::vector<double> seeds;
    for (const int b : which) {
      targets.push_back(queries_.targets[b]);
      const std::span<const double> seed = queries_.seed(b);
      seeds.insert(seeds.end(), seed.begin(), seed.end());
    }
    return IkBatch(chain_, targets, seeds, {.ik = options_, .threads = threads});
  };
  std::vector<int> order(size);
  std::iota(order.begin(), order.end(), 0);
  const IkBatchResult all = ask(order, 1);
  const auto expect_same = [&](const std::vector<int>& which, int threads) {
    const IkBatchResult some = ask(which, threads);
    for (int k = 0; k < some.size; ++k) {
      const int b = which[k];
      EXPECT_TRUE(std::ranges::equal(some.row(k), all.row(b))) << queries_.kinds[b];
      EXPECT_EQ(some.success[k], all.success[b]);
      EXPECT_EQ(some.position_error[k], all.position_error[b]);
      EXPECT_EQ(some.rotation_error[k], all.rotation_error[b]);
      EXPECT_EQ(some.iterations[k], all.iterations[b]);
    }
  };
  for (int b = 0; b < size; b += 4) expect_same({b}, 1);
  expect_same({5, 5, 0, 5}, 1);
  for (const int threads : {1, 2, 5}) {
    rng_.Shuffle(order);
    expect_same(order, threads);
  }
}

}  // namespace
}  // namespace robocell
