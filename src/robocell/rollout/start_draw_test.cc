#include "robocell/rollout/start_draw.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "robocell/base/hook_error.h"
#include "robocell/rollout/plan.h"
#include "robocell/rollout/testing/demo.h"
#include "robocell/task/start_sampler.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::Pair;

// Refuses, and records its requests.
class Recording : public TaskSampler {
 public:
  SampleResult Sample(const SampleRequest& request, Rng& rng) override {
    requests.push_back({request.scene, request.episode, request.attempt});
    drawn.push_back(rng.NextBits());
    return {.start = {}, .refusal = {.reason = "no"}};
  }
  std::vector<std::vector<int>> requests;
  std::vector<uint64_t> drawn;
};

// The stream of an attempt (plan.h) is the oracle, whatever was drawn before.
TEST(DrawStart, AttemptsHaveStreamsOfTheirOwn) {
  const RunConfig run = Demo();
  const DataFactory data;
  Recording sampler;
  const PlanItem item{.index = 3, .scene = 1, .episode = 2, .id = "e"};
  for (const int attempt : {0, 4, 0}) DrawStart({run, sampler, data}, item, attempt, {});
  EXPECT_THAT(sampler.requests,
              ElementsAre(ElementsAre(1, 2, 0), ElementsAre(1, 2, 4), ElementsAre(1, 2, 0)));
  EXPECT_EQ(sampler.drawn[0], sampler.drawn[2]);
  EXPECT_NE(sampler.drawn[0], sampler.drawn[1]);
  EXPECT_EQ(sampler.drawn[1], AttemptStream(run, item, 4, "start").NextBits());
}

TEST(DrawStart, AnErrorOfAUsersSamplerNamesTheHook) {
  class Raising : public TaskSampler {
    SampleResult Sample(const SampleRequest&, Rng&) override {
      throw std::runtime_error("no table");
    }
  } sampler;
  const RunConfig run = Demo();
  const DataFactory data;
  ExpectThrow<HookError>(
      [&] {
        DrawStart({run, sampler, data, true}, {}, 0, {});
      },
      "in sample: no table");
  ExpectThrow<std::runtime_error>(
      [&] {
        DrawStart({run, sampler, data, false}, {}, 0, {});
      },
      "no table");
}

TEST(RefusedStarts, AreCountedUnderTheirStage) {
  RefusedStarts refused;
  EXPECT_EQ(refused.Text(), "");
  refused.Add(Refusal{.reason = "a", .detail = "first"}.MadeBy(Refusal::kTaskStage));
  refused.Add(Refusal{.reason = "b", .detail = "second"});
  EXPECT_EQ(refused.detail(), "second") << "of the last of equally frequent reasons";
  refused.Add(Refusal{.reason = "a", .detail = "third"}.MadeBy(Refusal::kTaskStage));
  refused.Add(Refusal{.reason = Refusal::kNoReachableBasePose, .detail = "far"});
  EXPECT_THAT(refused.counts(), ElementsAre(Pair("b", 1), Pair(Refusal::kNoReachableBasePose, 1),
                                            Pair("task: a", 2)));
  EXPECT_EQ(refused.total(), 4);
  EXPECT_EQ(refused.out_of_reach(), 1);
  EXPECT_EQ(refused.detail(), "third");
  EXPECT_EQ(refused.Text(), ": b 1 time, no base pose reaches the object 1 time, task: a 2 times");
}

}  // namespace
}  // namespace robocell::internal
