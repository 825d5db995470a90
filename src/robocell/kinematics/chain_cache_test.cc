// Tests which chains share a result, and that few are kept.
#include "robocell/kinematics/chain_cache.h"

#include <gtest/gtest.h>

#include "robocell/kinematics/chain.h"
#include "robocell/kinematics/testing/models.h"

namespace robocell::internal {
namespace {

ChainModel ChainNumber(int k) {
  ChainModel chain;
  chain.n = 2;
  chain.joints[1].fixed.translation.x() = k;
  return chain;
}

struct Counted {
  ChainCache<int> cache;
  int computed = 0;

  int Get(const ChainModel& chain) {
    return *cache.Get(chain, [&] { return ++computed; });
  }
};

TEST(ChainCache, ChainsOfTwoModelsOfTheSameRobotShareAResult) {
  Rng rng = Rng::Stream(1, "chain cache");
  const std::string xml = RandomChainXml(&rng, {.joints = 6}).Write();
  const TestModel one = TestModel::FromXml(xml), other = TestModel::FromXml(xml);
  Counted counted;
  const ChainTip tip = ChainTip::Site("tip");
  EXPECT_EQ(counted.Get(Chain(one.model(), "base", tip).model()),
            counted.Get(Chain(other.model(), "base", tip).model()));
  EXPECT_EQ(counted.computed, 1);
}

TEST(ChainCache, MassesAndUnusedJointsMakeNoDifference) {
  ChainModel heavy = ChainNumber(1);
  heavy.joints[0].link.mass = 2;
  heavy.joints[0].armature = 1;
  heavy.joints[2].upper = 1;
  EXPECT_EQ(GeometryBits(heavy), GeometryBits(ChainNumber(1)));
}

TEST(ChainCache, EachNumberOfTheGeometryMakesADifference) {
  const std::vector<void (*)(ChainModel&)> changes = {
      [](ChainModel& c) { c.n = 3; },
      [](ChainModel& c) { c.reach_bound = 3; },
      [](ChainModel& c) { c.length = 3; },
      [](ChainModel& c) { c.joints[0].fixed.rotation(2, 1) = 0.1; },
      [](ChainModel& c) { c.joints[0].fixed.translation.z() = 0.1; },
      [](ChainModel& c) { c.joints[1].joint_to_body.translation.x() = 0.1; },
      [](ChainModel& c) { c.joints[1].slide = true; },
      [](ChainModel& c) { c.joints[1].reference = 0.1; },
      [](ChainModel& c) { c.joints[1].lower = -0.1; },
      [](ChainModel& c) { c.joints[1].upper = 0.1; },
      [](ChainModel& c) { c.last_to_tip.rotation(0, 0) = -1; },
      [](ChainModel& c) { c.last_to_tip.translation.y() = 0.1; },
  };
  for (size_t i = 0; i < changes.size(); ++i) {
    ChainModel changed = ChainNumber(1);
    changes[i](changed);
    EXPECT_NE(GeometryBits(changed), GeometryBits(ChainNumber(1))) << "change " << i;
  }
}

TEST(ChainCache, KeepsTheResultsThatWereUsedLast) {
  Counted counted;
  const int kMost = ChainCache<int>::kMostKept;
  const int first = counted.Get(ChainNumber(0));
  for (int k = 1; k < kMost; ++k) counted.Get(ChainNumber(k));
  EXPECT_EQ(counted.Get(ChainNumber(0)), first);
  counted.Get(ChainNumber(kMost));  // in the place of number 1
  EXPECT_EQ(counted.Get(ChainNumber(0)), first);
  EXPECT_EQ(counted.computed, kMost + 1);
  counted.Get(ChainNumber(1));
  EXPECT_EQ(counted.computed, kMost + 2);
}

TEST(ChainCache, AResultOutlivesItsPlaceInTheCache) {
  ChainCache<int> cache;
  const auto kept = cache.Get(ChainNumber(0), [] { return 7; });
  for (int k = 1; k < 20; ++k) cache.Get(ChainNumber(k), [] { return 0; });
  EXPECT_EQ(*kept, 7);
}

}  // namespace
}  // namespace robocell::internal
