#include "robocell/spec/action_noise_config.h"

#include <gtest/gtest.h>

#include <string>

#include "robocell/spec/run_config.h"
#include "robocell/spec/yaml.h"

namespace robocell {
namespace {

TEST(ActionNoiseConfigTest, RejectsRotationsOfMoreThanAQuarterTurn) {
  for (double ActionNoiseConfig::*field :
       {&ActionNoiseConfig::rotation, &ActionNoiseConfig::start_rotation}) {
    ActionNoiseConfig noise;
    noise.*field = 1.5;
    Problems good;
    noise.Validate(good);
    EXPECT_TRUE(good.empty());
    noise.*field = 1.7;
    Problems bad;
    noise.Validate(bad);
    EXPECT_EQ(bad.list().size(), 1U);
  }
}

TEST(ActionNoiseConfigTest, RejectsLengthsInMillimetres) {
  for (double ActionNoiseConfig::*field :
       {&ActionNoiseConfig::translation, &ActionNoiseConfig::start_translation}) {
    ActionNoiseConfig noise;
    noise.*field = 0.2;
    Problems good;
    noise.Validate(good);
    EXPECT_TRUE(good.empty());
    noise.*field = 5;
    Problems bad;
    noise.Validate(bad);
    EXPECT_EQ(bad.list().size(), 1U);
  }
}

TEST(ActionNoiseConfigTest, IsNotWrittenUnlessItIsSet) {
  RunConfig run;
  EXPECT_EQ(ToYaml(run).find("\nnoise:"), std::string::npos);
  run.noise.emplace().translation = 0.01;
  EXPECT_EQ(FromYamlUnchecked<RunConfig>(ToYaml(run)).noise, run.noise);
}

}  // namespace
}  // namespace robocell
