#include "robocell/kinematics/ik_choice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/rng.h"
#include "robocell/kinematics/ik_solutions.h"
#include "robocell/kinematics/testing/arm_tables.h"
#include "robocell/kinematics/testing/ik_judge.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

class IkChoiceOfPuma : public ::testing::Test {
 protected:
  Pose Reached() { return chain_.Fk(RandomJoints(chain_, &rng_)); }
  // Solves all targets in `shares` interleaved shares, one after another.
  std::vector<IkResult> Solve(const std::vector<Pose>& targets, const IkOptions& options,
                              int shares = 1) {
    std::vector<LaneQuery> queries;
    for (const Pose& target : targets)
      queries.push_back({.target = ToTransform(target), .seed = options.seed});
    std::vector<IkChoice::Search> searches(targets.size() * IkChoice::kSearches);
    std::vector<IkResult> answers(targets.size());
    IkChoice choice(chain_, options, queries, searches, answers);
    const std::atomic<bool> ended = false;
    do {
      for (int share = 0; share < shares; ++share) choice.Run(share, shares, ended, {});
    } while (choice.Choose());
    return answers;
  }
  // Returns the squared distance in joint space.
  double Distance(const JointVector& a, const JointVector& b) const {
    double sum = 0;
    for (int i = 0; i < a.size(); ++i) sum += std::pow(a[i] - b[i], 2);
    return sum;
  }

  Rng rng_ = Rng::Stream(1, "ik choice");
  TestModel model_ = TestModel::FromXml(ArmXml(Puma560()));
  Chain chain_{model_.model(), "base", ChainTip::Site("tip")};
};

// The oracle is the list of all solutions, of which an arm of six joints has a few.
TEST_F(IkChoiceOfPuma, TheNearestOfAllSolutionsIsChosen) {
  for (int k = 0; k < 5; ++k) {
    const Pose target = Reached();
    const JointVector seed = RandomJoints(chain_, &rng_);
    const IkResult chosen =
        Solve({target}, {.seed = seed, .prefer = IkPrefer::kSeed, .max_restarts = 200})[0];
    ASSERT_TRUE(chosen.success);
    EXPECT_TRUE(EngineAgrees(model_, chain_, target, chosen.q, 1.0001e-5));
    const std::vector<IkResult> all =
        IkSolutions(chain_, target, {.seed = seed, .max_restarts = 400});
    ASSERT_GT(all.size(), 1u);
    for (const IkResult& other : all)
      EXPECT_LE(Distance(chosen.q, seed), Distance(other.q, seed) + 1e-3) << k;
  }
}

TEST_F(IkChoiceOfPuma, AFilterExcludesSolutions) {
  // A single elbow: the third joint on one side of the middle of its range.
  const IkFilter up = [](std::span<const double> q, int count, std::span<uint8_t> keep) {
    for (int b = 0; b < count; ++b) keep[b] = q[6 * b + 2] > -std::numbers::pi / 2;
  };
  int solved = 0;
  for (int k = 0; k < 10; ++k) {
    const IkResult chosen = Solve({Reached()}, {.filter = up})[0];
    if (!chosen.success) continue;
    EXPECT_GT(chosen.q[2], -std::numbers::pi / 2);
    ++solved;
  }
  EXPECT_GE(solved, 8);
  const IkFilter none = [](std::span<const double>, int, std::span<uint8_t> keep) {
    std::fill(keep.begin(), keep.end(), uint8_t{0});
  };
  const IkResult refused = Solve({Reached()}, {.filter = none})[0];
  EXPECT_FALSE(refused.success);
  EXPECT_LE(refused.position_error, 1e-5) << "one of the refused solutions";
}

TEST_F(IkChoiceOfPuma, TheResultDependsOnTheQueryAlone) {
  std::vector<Pose> targets;
  for (int k = 0; k < 7; ++k) targets.push_back(Reached());
  const IkOptions options{.prefer = IkPrefer::kAwayFromLimits};
  const std::vector<IkResult> together = Solve(targets, options, 1),
                              shared = Solve(targets, options, 3);
  for (size_t k = 0; k < targets.size(); ++k) {
    const IkResult alone = Solve({targets[k]}, options)[0];
    for (const IkResult& other : {together[k], shared[k]}) {
      EXPECT_EQ(std::vector<double>(other.q.begin(), other.q.end()),
                std::vector<double>(alone.q.begin(), alone.q.end()))
          << k;
      EXPECT_EQ(other.restarts, alone.restarts);
    }
  }
}

TEST_F(IkChoiceOfPuma, EndsWithTheExceptionOfItsPoll) {
  const size_t count = 100;
  const std::vector<LaneQuery> queries(count, {.target = ToTransform(Reached())});
  std::vector<IkChoice::Search> searches(count * IkChoice::kSearches);
  std::vector<IkResult> answers(count);
  // Solutions are never near enough, so that every search restarts.
  const IkOptions options{
      .tolerance = 1e-30, .prefer = IkPrefer::kAwayFromLimits, .max_restarts = 999};
  IkChoice choice(chain_, options, queries, searches, answers);
  const std::atomic<bool> ended = false;
  ExpectThrow<Error>([&] { choice.Run(0, 1, ended, [] { throw Error("interrupted"); }); },
                     "interrupted");
}

TEST_F(IkChoiceOfPuma, NothingRunsOnceItHasEnded) {
  const LaneQuery query{.target = ToTransform(Reached())};
  std::vector<IkChoice::Search> searches(IkChoice::kSearches);
  IkResult answer;
  const IkOptions options{.prefer = IkPrefer::kAwayFromLimits};
  IkChoice choice(chain_, options, {&query, 1}, searches, {&answer, 1});
  const std::atomic<bool> ended = true;
  choice.Run(0, 1, ended, {});
  for (const IkChoice::Search& search : searches) EXPECT_FALSE(search.found.success);
}

TEST_F(IkChoiceOfPuma, SolutionsAWholeTurnApartAreOne) {
  const ChainModel& chain = chain_.model();
  const JointVector q = RandomJoints(chain_, &rng_);
  JointVector other = q;
  other[5] += 2 * std::numbers::pi;
  EXPECT_FALSE(AreApart(chain, q, other, kAnother));
  other[5] += 0.06;
  EXPECT_TRUE(AreApart(chain, q, other, kAnother));
}

TEST(IkChoice, SlidesAreApartByLengthsOfTheChain) {
  const TestModel t =
      TestModel::FromXml(ArmXml({{0.5, 0, 0, -3, 3}, {0, 0, 0.5, -9, 9, /*slide=*/true}}));
  const Chain chain(t.model(), "base", ChainTip::Site("tip"));
  const double length = chain.model().length;
  const JointVector q{0.1, 0.2};
  EXPECT_FALSE(AreApart(chain.model(), q, JointVector{0.1, 0.2 + 0.04 * length}, kAnother));
  EXPECT_TRUE(AreApart(chain.model(), q, JointVector{0.1, 0.2 + 0.06 * length}, kAnother));
}

TEST_F(IkChoiceOfPuma, AllSolutionsAreSearchedWithManyStartsAndWithoutRedundantJoints) {
  const IkOptions many{.max_restarts = kFewStarts - 1}, few{.max_restarts = kFewStarts - 2};
  EXPECT_TRUE(LooksForAll(chain_, IkTask(many), many));
  EXPECT_FALSE(LooksForAll(chain_, IkTask(few), few));
  const IkOptions position{.position_only = true};
  EXPECT_FALSE(LooksForAll(chain_, IkTask(position), position)) << "three joints are redundant";
}

TEST(IkChoice, TheSearchEndsAfterQuietStarts) {
  const IkOptions options{.max_restarts = 100};
  EXPECT_TRUE(MayFindAnother(options, 10, 60, 50));
  EXPECT_FALSE(MayFindAnother(options, 10, 61, 50));
  EXPECT_TRUE(MayFindAnother(options, 2100, 2100, 50));
  EXPECT_FALSE(MayFindAnother(options, 2101, 2101, 50)) << "singular poses never end";
}

TEST(IkChoice, PreferencesAndFiltersNeedAChoice) {
  EXPECT_FALSE(IsChosen({}));
  EXPECT_TRUE(IsChosen({.prefer = IkPrefer::kManipulability}));
  EXPECT_TRUE(IsChosen({.filter = [](auto, int, auto) {}}));
}

}  // namespace
}  // namespace robocell::internal
