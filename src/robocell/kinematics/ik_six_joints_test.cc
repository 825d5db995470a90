// Tests arms of six joints without redundancy: three parallel axes, a spherical wrist, a slide, and
// the arm of the examples. The engine is the judge.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>

#include "robocell/base/units.h"
#include "robocell/kinematics/ik_batch.h"
#include "robocell/kinematics/ik_solutions.h"
#include "robocell/kinematics/testing/arm_tables.h"
#include "robocell/kinematics/testing/ik_judge.h"
#include "robocell/testing/source_dir.h"

namespace robocell {
namespace {

constexpr double kSixTolerance = 1e-5;

struct SixJoints {
  std::string name;
  std::vector<TableRow> rows;
};

void PrintTo(const SixJoints& arm, std::ostream* out) { *out << arm.name; }

std::vector<SixJoints> SixJointArms() {
  const double turn = 2 * std::numbers::pi, half = std::numbers::pi;
  return {// Universal Robots' UR5e, from its maker's table.
          {"ur5e",
           {{0, kQuarterTurn, 0.1625, -turn, turn},
            {-0.425, 0, 0, -turn, turn},
            {-0.3922, 0, 0, -half, half},
            {0, kQuarterTurn, 0.1333, -turn, turn},
            {0, -kQuarterTurn, 0.0997, -turn, turn},
            {0, 0, 0.0996, -turn, turn}}},
          {"puma560", Puma560()},
          // The Stanford arm, whose third joint slides.
          {"stanford",
           {{0, -kQuarterTurn, 0.412, internal::Radians(-170), internal::Radians(170)},
            {0, kQuarterTurn, 0.154, internal::Radians(-170), internal::Radians(170)},
            {0, 0, 0, 0.3048, 1.27, true},
            {0, -kQuarterTurn, 0, internal::Radians(-170), internal::Radians(170)},
            {0, kQuarterTurn, 0, internal::Radians(-90), internal::Radians(90)},
            {0, 0, 0.263, internal::Radians(-170), internal::Radians(170)}}},
          {"desk6", {}}};
}

class ArmOfSixJoints : public testing::TestWithParam<SixJoints> {
 protected:
  static TestModel Load() {
    if (!GetParam().rows.empty()) return TestModel::FromXml(ArmXml(GetParam().rows));
    std::ifstream file(SourceDir() + "/examples/desk6/desk6.xml");
    return TestModel::FromXml({std::istreambuf_iterator<char>(file), {}});
  }
  std::vector<Pose> Reached(int count) {
    std::vector<Pose> targets;
    for (int b = 0; b < count; ++b) targets.push_back(chain_.Fk(RandomJoints(chain_, &rng_)));
    return targets;
  }
  // Every claimed solution must convince the engine.
  int CountSolved(const std::vector<Pose>& targets, const IkOptions& options) {
    const IkBatchResult result = IkBatch(chain_, targets, {}, {.ik = options});
    int convinced = 0;
    for (int b = 0; b < result.size; ++b) {
      EXPECT_TRUE(InLimits(chain_, result.row(b)));
      if (!result.success[b]) continue;
      convinced +=
          EngineAgrees(model_, chain_, targets[b], result.row(b), 1.0001 * options.tolerance);
    }
    EXPECT_EQ(convinced, result.solved());
    return result.solved();
  }

  Rng rng_ = Rng::Stream(1, "six joints", GetParam().name);
  TestModel model_ = Load();
  Chain chain_{model_.model(), "base", ChainTip::Site(GetParam().rows.empty() ? "tcp" : "tip")};
};
INSTANTIATE_TEST_SUITE_P(Arms, ArmOfSixJoints, testing::ValuesIn(SixJointArms()),
                         [](const auto& info) { return info.param.name; });

// Requires at least 99.9 %.
TEST_P(ArmOfSixJoints, SolvesTwentyThousandReachableTargetsWithinTheLimits) {
  ASSERT_EQ(chain_.n_joints(), 6);
  EXPECT_GE(CountSolved(Reached(20000), {.tolerance = kSixTolerance}), 19990);
}

TEST_P(ArmOfSixJoints, SolvesToTightTolerances) {
  EXPECT_GE(CountSolved(Reached(2000), {.tolerance = 1e-8}), 1998);
}

TEST_P(ArmOfSixJoints, SolvesSingleQueries) {
  int solved = 0;
  for (const Pose& target : Reached(1000)) {
    const IkResult found = Ik(chain_, target, {.tolerance = kSixTolerance});
    EXPECT_TRUE(InLimits(chain_, found.q));
    if (!found.success) continue;
    EXPECT_TRUE(EngineAgrees(model_, chain_, target, found.q, 1.0001 * kSixTolerance));
    ++solved;
  }
  EXPECT_GE(solved, 999);
}

// Queries for the best solution, or for one that a filter keeps, succeed as often.
TEST_P(ArmOfSixJoints, SolvesAsManyTargetsWithAPreference) {
  const std::vector<Pose> targets = Reached(1000);
  const IkFilter all = [](std::span<const double>, int, std::span<uint8_t> keep) {
    std::fill(keep.begin(), keep.end(), uint8_t{1});
  };
  for (const IkOptions& options :
       {IkOptions{.prefer = IkPrefer::kAwayFromLimits},
        IkOptions{.prefer = IkPrefer::kManipulability},
        IkOptions{.prefer = IkPrefer::kPosture, .posture = RandomJoints(chain_, &rng_)},
        IkOptions{.filter = all}})
    EXPECT_GE(CountSolved(targets, options), 999);
}

// The configuration that a pose was made from is among all of its solutions.
TEST_P(ArmOfSixJoints, FindsTheKnownSolutionAmongAll) {
  int known = 0;
  for (int k = 0; k < 100; ++k) {
    const JointVector truth = RandomJoints(chain_, &rng_);
    const std::vector<IkResult> all = IkSolutions(chain_, chain_.Fk(truth), {.max_restarts = 400});
    known += std::any_of(all.begin(), all.end(), [&](const IkResult& found) {
      for (int i = 0; i < 6; ++i) {
        const double off = found.q[i] - truth[i];
        const bool slide = chain_.joints()[i].type == ChainJointType::kSlide;
        if (std::abs(slide ? off : std::remainder(off, 2 * std::numbers::pi)) > 0.05) return false;
      }
      return true;
    });
  }
  EXPECT_GE(known, 95);
}

// Compares modulo whole turns of hinges.
bool AreTheSame(const Chain& chain, const JointVector& a, const JointVector& b) {
  for (int i = 0; i < a.size(); ++i) {
    const double off = a[i] - b[i];
    const bool slide = chain.joints()[i].type == ChainJointType::kSlide;
    if (std::abs(slide ? off : std::remainder(off, 2 * std::numbers::pi)) > 0.1) return false;
  }
  return true;
}

TEST_P(ArmOfSixJoints, FindsAsManySolutionsAsAMuchLongerSearch) {
  int missed = 0, count = 0;
  for (const Pose& target : Reached(60)) {
    const std::vector<IkResult> found = IkSolutions(chain_, target, {.max_restarts = 199});
    for (const IkResult& one : IkSolutions(chain_, target, {.max_restarts = 4000})) {
      ++count;
      missed += std::none_of(found.begin(), found.end(), [&](const IkResult& other) {
        return AreTheSame(chain_, one.q, other.q);
      });
    }
  }
  EXPECT_GT(count, 60);
  EXPECT_EQ(missed, 0) << count;
}

// Without redundant joints the best is one of a few, and all of them are compared.
TEST_P(ArmOfSixJoints, PrefersTheSolutionNearestToTheSeedOrPosture) {
  int farther = 0;
  for (const Pose& target : Reached(100)) {
    const JointVector seed = RandomJoints(chain_, &rng_);
    const auto distance = [&](const IkResult& found) {
      double sum = 0;
      for (int i = 0; i < seed.size(); ++i) {
        const bool slide = chain_.joints()[i].type == ChainJointType::kSlide;
        const double unit = slide ? chain_.model().length : 1;
        sum += std::pow((found.q[i] - seed[i]) / unit, 2);
      }
      return std::sqrt(sum);
    };
    const double nearest =
        distance(IkSolutions(chain_, target, {.seed = seed, .max_restarts = 2000}).front());
    const IkOptions near_seed{.seed = seed, .prefer = IkPrefer::kSeed};
    const IkOptions near_posture{.prefer = IkPrefer::kPosture, .posture = seed};
    for (const IkOptions& options : {near_seed, near_posture})
      farther += distance(Ik(chain_, target, options)) > nearest + 1e-2;
  }
  EXPECT_LE(farther, 2);
}

// Rounding sometimes makes a repeated solution slightly nearer, which is no reason to continue.
TEST_P(ArmOfSixJoints, CountsRestartsUntilThePreferredSolution) {
  int same = 0;
  for (const Pose& target : Reached(100)) {
    const JointVector seed = RandomJoints(chain_, &rng_);
    const IkOptions best{.seed = seed, .prefer = IkPrefer::kSeed};
    IkOptions near = best;
    near.max_restarts = 46;  // ends with the first solution
    const IkResult first = Ik(chain_, target, near), all = Ik(chain_, target, best);
    if (!first.success || !AreTheSame(chain_, first.q, all.q)) continue;
    EXPECT_LE(all.restarts, first.restarts);
    ++same;
  }
  EXPECT_GT(same, 50);
}

}  // namespace
}  // namespace robocell
