// Tests that batched inverse kinematics gives the same results as single queries, whatever the
// batch, the order and the threads.
#include "robocell/kinematics/ik_batch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <thread>

#include "robocell/kinematics/testing/models.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

class IkBatchTest : public testing::Test {
 protected:
  IkBatchTest() {
    for (int b = 0; b < 40; ++b) {
      JointVector q(chain_.n_joints());
      for (double& v : q) v = rng_.Uniform(-1, 1);
      // Every fifth target is out of reach.
      targets_.push_back(b % 5 == 4 ? Pose(Eigen::Vector3d(50, b, 0)) : chain_.Fk(q));
      for (const double v : q) seeds_.push_back(v + rng_.Uniform(-0.3, 0.3));
    }
  }

  Rng rng_ = Rng::Stream(1, "ik batch");
  TestModel model_ =
      TestModel::FromXml(RandomChainXml(&rng_, {.joints = 7, .slide_share = 0}).Write());
  Chain chain_{model_.model(), "base", ChainTip::Site("tip")};
  std::vector<Pose> targets_;
  std::vector<double> seeds_;
};

TEST_F(IkBatchTest, SolvesEachQueryAsIfAlone) {
  const IkBatchResult all = IkBatch(chain_, targets_, seeds_);
  ASSERT_EQ(all.size, 40);
  EXPECT_EQ(all.solved(), 32);
  for (int b = 0; b < all.size; ++b) {
    const std::span<const double> seed = std::span(seeds_).subspan(b * 7, 7);
    const IkBatchResult alone = IkBatch(chain_, {&targets_[b], 1}, seed);
    EXPECT_TRUE(std::ranges::equal(alone.q, all.row(b))) << b;
    EXPECT_EQ(alone.success[0], all.success[b]);
    EXPECT_EQ(alone.iterations[0], all.iterations[b]);
    EXPECT_EQ(alone.position_error[0], all.position_error[b]);
    EXPECT_EQ(alone.rotation_error[0], all.rotation_error[b]);
    EXPECT_EQ(all.success[b], b % 5 != 4);
  }
}

TEST_F(IkBatchTest, DoesNotDependOnOrderOrThreads) {
  // Enough targets for each thread.
  while (targets_.size() < 400) targets_.push_back(targets_[targets_.size() - 40]);
  const IkBatchResult all = IkBatch(chain_, targets_);
  const IkBatchResult threaded = IkBatch(chain_, targets_, {}, {.threads = 3});
  EXPECT_EQ(all.q, threaded.q);
  EXPECT_EQ(all.success, threaded.success);
  std::ranges::reverse(targets_);
  const IkBatchResult reversed = IkBatch(chain_, targets_);
  for (int b = 0; b < all.size; ++b)
    EXPECT_TRUE(std::ranges::equal(reversed.row(399 - b), all.row(b))) << b;
}

// Several threads use data that a chain makes on first use.
TEST_F(IkBatchTest, ManyThreadsCanQueryANewChain) {
  const IkBatchResult expected = IkBatch(chain_, targets_);
  const Chain fresh(model_.model(), "base", ChainTip::Site("tip"));
  std::vector<IkBatchResult> results(3);
  {
    std::vector<std::jthread> threads;
    for (IkBatchResult& result : results)
      threads.emplace_back([&] { IkBatch(fresh, targets_, {}, {}, &result); });
  }
  for (const IkBatchResult& result : results) EXPECT_EQ(result.q, expected.q);
}

TEST_F(IkBatchTest, AppliesOneSeedToAllTargets) {
  const std::span<const double> seed = std::span(seeds_).first(7);
  const IkBatchResult result = IkBatch(chain_, targets_, seed);
  std::vector<double> repeated;
  for (int b = 0; b < result.size; ++b) repeated.insert(repeated.end(), seed.begin(), seed.end());
  EXPECT_EQ(result.q, IkBatch(chain_, targets_, repeated).q);
}

TEST_F(IkBatchTest, ReusesTheMemoryOfTheResult) {
  IkBatchResult result;
  IkBatch(chain_, targets_, seeds_, {}, &result);
  const double* memory = result.q.data();
  IkBatch(chain_, std::span(targets_).first(10), {}, {}, &result);
  EXPECT_EQ(result.size, 10);
  EXPECT_EQ(result.q.size(), 70u);
  EXPECT_EQ(result.q.data(), memory);
}

TEST_F(IkBatchTest, EndsWithTheExceptionOfItsPoll) {
  // Enough targets that the helpers leave some to the caller, however rarely it gets a core.
  while (targets_.size() < 50000) targets_.push_back(targets_[targets_.size() % 40]);
  for (const int threads : {1, 3}) {
    int polls = 0;
    const IkBatchOptions options{.threads = threads, .poll = [&] {
                                   if (++polls == 3) throw Error("interrupted");
                                 }};
    ExpectThrow<Error>([&] { IkBatch(chain_, targets_, {}, options); }, "interrupted");
    EXPECT_EQ(polls, 3);
  }
}

// With small position weights no target is too far, so each takes all starts.
TEST_F(IkBatchTest, OneHardQueryEndsWithTheExceptionOfItsPoll) {
  const IkOptions hard{.position_weights = {0.5, 0.5, 0.5}, .max_restarts = 1'000'000'000};
  const Pose far(Eigen::Vector3d(0, 0, 50));
  for (const bool filtered : {false, true}) {
    IkOptions ik = hard;
    if (filtered) ik.filter = [](std::span<const double>, int, std::span<uint8_t>) {};
    const auto interrupted = [&](const auto& ask) {
      int polls = 0;
      const std::function<void()> poll = [&] {
        if (++polls == 3) throw Error("interrupted");
      };
      ExpectThrow<Error>([&] { ask(poll); }, "interrupted");
      EXPECT_EQ(polls, 3);
    };
    interrupted([&](const auto& poll) { Ik(chain_, far, ik, poll); });
    for (const int threads : {1, 3}) {
      const std::vector<Pose> targets(200, far);
      interrupted([&](const auto& poll) {
        IkBatch(chain_, targets, {}, {.ik = ik, .threads = threads, .poll = poll});
      });
    }
  }
}

TEST_F(IkBatchTest, ReturnsAnEmptyResultForAnEmptyBatch) {
  const IkBatchResult result = IkBatch(chain_, {});
  EXPECT_EQ(result.size, 0);
  EXPECT_EQ(result.solved(), 0);
}

TEST_F(IkBatchTest, NamesAnInvalidRowBeforeSolving) {
  ExpectThrow<ArgumentError>(
      [&] { IkBatch(chain_, targets_, std::span(seeds_).first(8)); },
      "expected 7 seed values (one seed) or 280 (40 seeds of 7 joints), got 8");
  seeds_[17 * 7 + 2] = INFINITY;
  ExpectThrow<ArgumentError>([&] { IkBatch(chain_, targets_, seeds_); }, "seeds[17][2] is inf");
  const Pose huge(Eigen::Vector3d(1.5e308, 0, 0));
  targets_[12] = huge * huge;
  ExpectThrow<ArgumentError>([&] { IkBatch(chain_, targets_); },
                             "targets[12] has a number that is not finite");
  ExpectThrow<ArgumentError>([&] { IkBatch(chain_, {}, {}, {.threads = 0}); },
                             "threads is 0; it must be 1 or more");
  ExpectThrow<ArgumentError>([&] { IkBatch(chain_, {}, {}, {.ik = {.seed = JointVector(7)}}); },
                             "options.ik.seed is set; pass seeds as the third argument");
}

}  // namespace
}  // namespace robocell
