#include "robocell/rollout/plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "robocell/base/error.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

RunConfig RunOf(std::vector<int> houses, int per_scene) {
  RunConfig run;
  run.run = "plan";
  run.scenes.houses.values = std::move(houses);
  run.episodes_per_scene = per_scene;
  return run;
}

std::vector<std::string> Ids(const std::vector<PlanItem>& plan) {
  std::vector<std::string> ids;
  for (const PlanItem& item : plan) ids.push_back(item.id);
  return ids;
}

TEST(Plan, AlternatesScenes) {
  EXPECT_THAT(Ids(MakePlan(RunOf({2, 5}, 2))),
              testing::ElementsAre("s0002_e0000", "s0005_e0000", "s0002_e0001", "s0005_e0001"));
}

TEST(Plan, FewEpisodesStillVisitAllScenes) {
  RunConfig run = RunOf({0, 1, 2}, 10);
  run.episodes = 3;
  EXPECT_THAT(Ids(MakePlan(run)),
              testing::ElementsAre("s0000_e0000", "s0001_e0000", "s0002_e0000"));
}

TEST(Plan, EpisodesIsTheTotalNumber) {
  RunConfig run = RunOf({4, 7}, 1);
  run.episodes = 5;
  EXPECT_THAT(Ids(MakePlan(run)), testing::ElementsAre("s0004_e0000", "s0007_e0000", "s0004_e0001",
                                                       "s0007_e0001", "s0004_e0002"));
}

TEST(Plan, RejectsAnExcessiveNumberOfEpisodes) {
  ExpectThrow<SpecError>(
      [] {
        MakePlan(RunOf({0, 1}, 2'000'000'000));
      },
      "run 'plan': 2 scenes with episodes_per_scene: 2000000000 makes "
      "4000000000 episodes; 10000000 is the most in one dataset");
}

TEST(Plan, ExtendingAPlanKeepsIdsAndStreams) {
  const RunConfig small = RunOf({0, 1}, 2);
  const RunConfig large = RunOf({0, 1, 2, 3}, 5);
  const std::vector<PlanItem> more = MakePlan(large);
  for (const PlanItem& item : MakePlan(small)) {
    const auto same =
        std::find_if(more.begin(), more.end(), [&](const PlanItem& m) { return m.id == item.id; });
    ASSERT_NE(same, more.end()) << item.id;
    EXPECT_EQ(AttemptStream(small, item, 1, "start").NextBits(),
              AttemptStream(large, *same, 1, "start").NextBits());
  }
  EXPECT_EQ(RunIdentity(small), RunIdentity(large));
}

TEST(Plan, EveryAttemptAndPurposeHasItsOwnStream) {
  const RunConfig run = RunOf({0}, 3);
  std::set<uint64_t> seen;
  for (const PlanItem& item : MakePlan(run)) {
    for (int attempt = 0; attempt < 3; ++attempt) {
      for (const char* purpose : {"start", "expert"})
        seen.insert(AttemptStream(run, item, attempt, purpose).NextBits());
    }
  }
  EXPECT_EQ(seen.size(), 18u);
}

TEST(Plan, TheIdentityDependsOnTheSeedButNotOnWorkersOrOutput) {
  RunConfig a = RunOf({0}, 1), b = a;
  b.workers = 7;
  b.output = "elsewhere";
  EXPECT_EQ(RunIdentity(a), RunIdentity(b));
  b.seed = 1;
  EXPECT_NE(RunIdentity(a), RunIdentity(b));
}

TEST(Shards, PartitionThePlan) {
  const std::vector<PlanItem> plan = MakePlan(RunOf({0, 1, 2}, 5));
  for (int count = 1; count <= 17; ++count) {
    std::multiset<std::string> all;
    for (int i = 0; i < count; ++i) {
      for (const PlanItem& item : Shard(plan, i, count)) all.insert(item.id);
    }
    const std::vector<std::string> ids = Ids(plan);
    EXPECT_EQ(all, std::multiset<std::string>(ids.begin(), ids.end())) << count;
  }
}

TEST(Shards, AreParsedFromText) {
  EXPECT_EQ(ParseShard("3/8").shard, 3);
  EXPECT_EQ(ParseShard("3/8").count, 8);
  for (const char* bad : {"", "3", "8/8", "-1/8", "1/0", "a/b", "1/8x", "1 /8"}) {
    EXPECT_THROW(ParseShard(bad), ArgumentError) << bad;
  }
  try {
    ParseShard("8/8");
  } catch (const ArgumentError& e) {
    EXPECT_STREQ(e.what(), "'8/8' is not a shard: write i/N with 0 <= i < N, for example 0/8");
  }
}

}  // namespace
}  // namespace robocell
