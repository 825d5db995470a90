#include "robocell/task/start_turn.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

const std::vector<std::string> kOptions = {"a", "b", "c", "d", "e", "f", "g", "h"};

TEST(StartTurn, OptionsAlternateOverScenesAndEpisodes) {
  const auto count = static_cast<int>(kOptions.size());
  struct Shape {
    int scenes, episodes_of_each;
  };
  for (const auto& [scenes, episodes] :
       {Shape{20, 1}, {20, 2}, {40, 3}, {1, 20}, {3, 7}, {3, 16}}) {
    // Complete squares of scenes and episodes contain all options equally often; the rest adds one
    // of each at most.
    const int uneven = std::min(scenes % count, episodes % count);
    for (uint64_t seed = 0; seed < 30; ++seed) {
      std::map<std::string, int> counts;
      for (const std::string& option : kOptions) counts[option] = 0;
      for (int scene = 0; scene < scenes; ++scene) {
        for (int episode = 0; episode < episodes; ++episode)
          ++counts[StartTurn{seed, scene, episode}.Choose(kOptions)];
      }
      const auto [least, most] = std::minmax_element(
          counts.begin(), counts.end(), [](auto& a, auto& b) { return a.second < b.second; });
      EXPECT_LE(most->second - least->second, uneven)
          << scenes << " scenes of " << episodes << ", seed " << seed << ": " << least->first << ' '
          << least->second << ", " << most->first << ' ' << most->second;
      EXPECT_EQ(counts.size(), kOptions.size());
    }
  }
}

TEST(StartTurn, EachSquareHasAnOrderOfItsOwn) {
  std::set<std::string> orders;
  for (int square = 0; square < 6; ++square) {
    std::string order;
    for (int i = 0; i < 8; ++i) order += StartTurn{3, 0, 8 * square + i}.Choose(kOptions);
    orders.insert(order);
  }
  EXPECT_GE(orders.size(), 5u);
}

TEST(StartTurn, RequiresAnOption) {
  ExpectThrow<ArgumentError>([] { (void)StartTurn().Choose({}); }, "give at least one");
}

}  // namespace
}  // namespace robocell
