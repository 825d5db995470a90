#include "robocell/spec/pinned_values.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "robocell/base/error.h"
#include "robocell/spec/problems.h"
#include "robocell/spec/randomize_config.h"
#include "robocell/spec/types.h"
#include "robocell/spec/yaml.h"

namespace robocell::internal {
namespace {

using ::testing::HasSubstr;

std::string ProblemsOf(const std::string& block) {
  Problems problems;
  ValidatePinned(FromYamlUnchecked<RandomizeConfig>(block), problems);
  try {
    problems.Throw("run 'r'");
  } catch (const SpecError& error) {
    return error.what();
  }
  return "";
}

TEST(PinnedValues, AreWithinTheRangesOfDrawnOnes) {
  const auto pin = [](const std::string& entry) { return ProblemsOf("{pinned: {" + entry + "}}"); };
  EXPECT_THAT(pin("light/number: 2e9"),
              HasSubstr("must be a whole number between 0 and 4; is [2e+09]"));
  EXPECT_THAT(pin("light/number: 1.5"), HasSubstr("a whole number"));
  EXPECT_THAT(pin("light/-1/intensity: 0.5"), HasSubstr("no randomized value"));
  EXPECT_THAT(pin("light/0/intensty: 0.5"), HasSubstr("Did you mean 'light/0/intensity'?"));
  EXPECT_THAT(pin("clutter/number: 2"), HasSubstr("the block has no clutter"));
  EXPECT_THAT(ProblemsOf("{clutter: {}, pinned: {clutter/number: 2.7}}"),
              HasSubstr("a whole number between 0 and 20"));
  EXPECT_THAT(pin("cube/mass_scale: 0"), HasSubstr("of at least 1e-09"));
  EXPECT_THAT(pin("cube/colour: [1, 0, 2]"), HasSubstr("red, green and blue"));
  EXPECT_THAT(pin("cube/colour: 1"), HasSubstr("red, green and blue"));
  EXPECT_THAT(pin("cube/texture: marbel"), HasSubstr("Did you mean 'marble'?"));
  EXPECT_THAT(pin("cube/texture: 3"), HasSubstr("must be a word"));
  EXPECT_THAT(pin("cube/texture_seed: -1"), HasSubstr("between 0 and 4294967295"));
  EXPECT_THAT(pin("cube/gain: 2"), HasSubstr("is a factor: write 'cube/gain_scale'"));
  EXPECT_EQ(ProblemsOf("{clutter: {}, pinned: {clutter/number: 2, clutter/0/kind: mug, "
                       "light/number: 4, light/3/azimuth: -90, sky/zenith: [0, 0.5, 1], "
                       "left/arm/damping_scale: 0, cube/texture: ./oak.png, action_delay: 0.01}}"),
            "");
}

TEST(PinnedValues, LooksAreThoseOfTargets) {
  for (const char* name : {"table/texture", "left/arm/colour_scale", "cube/specular"})
    EXPECT_TRUE(IsLookName(name)) << name;
  for (const char* name : {"light/0/colour", "sky/horizon", "cube/mass", "action_delay", "colour"})
    EXPECT_FALSE(IsLookName(name)) << name;
}

TEST(PinnedValues, TheLongestDelayIsThePinnedOne) {
  RandomizeConfig config;
  EXPECT_FALSE(LongestDelay(config));
  config.action_delay.emplace().uniform = Vec2{0.01, 0.03};
  EXPECT_EQ(LongestDelay(config), 0.03);
  config.pinned["action_delay"].numbers = {0.02};
  EXPECT_EQ(LongestDelay(config), 0.02);
}

}  // namespace
}  // namespace robocell::internal
