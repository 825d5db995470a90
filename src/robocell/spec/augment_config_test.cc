#include "robocell/spec/augment_config.h"

#include <gtest/gtest.h>

#include "robocell/spec/run_config.h"
#include "robocell/spec/yaml.h"

namespace robocell {
namespace {

TEST(AugmentConfigTest, NeedsASourceAndExcludesAnExpert) {
  auto run = FromYamlUnchecked<RunConfig>(
      "{run: many, output: out, augment: {dataset: out/few, episodes: e0..e3}}");
  const auto problems = [&] {
    Problems problems;
    run.Validate(problems);
    return LinesOf(problems);
  };
  ASSERT_TRUE(run.augment.has_value());
  EXPECT_EQ(run.augment->dataset, "out/few");
  EXPECT_EQ(run.augment->episodes.names.size(), 4U);
  const size_t before = problems().size();
  run.expert = "pick";
  EXPECT_EQ(problems().size(), before + 1);
  Problems missing;
  AugmentConfig().Validate(missing);
  EXPECT_FALSE(missing.empty());
}

TEST(AugmentConfigTest, RejectsNoiseThatLeavesTheObject) {
  for (double AugmentConfig::*field :
       {&AugmentConfig::translation_noise, &AugmentConfig::rotation_noise}) {
    AugmentConfig augment{.dataset = "few"};
    Problems good;
    augment.Validate(good);
    EXPECT_TRUE(good.empty());
    augment.*field = 5;
    Problems bad;
    augment.Validate(bad);
    EXPECT_EQ(bad.list().size(), 1U);
  }
}

TEST(AugmentConfigTest, IsNotWrittenUnlessItIsSet) {
  RunConfig run;
  EXPECT_EQ(ToYaml(run).find("augment"), std::string::npos);
  run.augment.emplace().dataset = "few";
  EXPECT_EQ(FromYamlUnchecked<RunConfig>(ToYaml(run)).augment, run.augment);
}

}  // namespace
}  // namespace robocell
