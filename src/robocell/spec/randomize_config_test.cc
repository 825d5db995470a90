#include "robocell/spec/randomize_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "robocell/base/error.h"
#include "robocell/spec/run_config.h"
#include "robocell/spec/yaml.h"

namespace robocell {
namespace {

using ::testing::HasSubstr;

constexpr const char* kRun =
    "run: r\nrobot: {name: a, model: a.xml}\ntask: {kind: pick}\noutput: o\n";

RandomizeConfig Read(const std::string& block) { return FromYamlUnchecked<RandomizeConfig>(block); }

std::string ProblemsOf(const std::string& block) {
  try {
    ParseYaml<RunConfig>(std::string(kRun) + "randomize: " + block, "run.yaml");
  } catch (const SpecError& error) {
    return error.what();
  }
  return "";
}

TEST(RandomizeConfig, ANumberPinsAndDistributionsAreRead) {
  const RandomizeConfig config = Read(
      "lights: {intensity: 0.4, azimuth: {uniform: [-90, 90]}}\n"
      "dynamics: {cube: {mass: {scale: {log_uniform: [0.5, 2]}}, friction: 0.7}}\n"
      "pinned: {light/0/intensity: 0.3, cube/colour: [1, 0, 0.5], table/texture: wood}\n");
  EXPECT_EQ(config.lights->intensity->value, 0.4);
  EXPECT_EQ(config.lights->azimuth->uniform, (Vec2{-90, 90}));
  EXPECT_EQ(config.dynamics.at("cube").mass->scale->log_uniform, (Vec2{0.5, 2}));
  EXPECT_EQ(config.dynamics.at("cube").friction->value, 0.7);
  EXPECT_EQ(config.pinned.at("cube/colour").numbers, (std::vector<double>{1, 0, 0.5}));
  EXPECT_EQ(config.pinned.at("table/texture").word, "wood");
  EXPECT_EQ(Read(ToYaml(config)), config);
}

TEST(RandomizeConfig, WhatIsWrongIsNamedWithThePlaceAndWhatIsAllowed) {
  EXPECT_THAT(ProblemsOf("{lights: {intensity: {uniform: [0.5, 1.5]}}}"),
              HasSubstr("randomize.lights.intensity: intensity is between 0 and 1, and this can "
                        "give 1.5"));
  EXPECT_THAT(ProblemsOf("{lights: {number: {uniform: [1, 3]}}}"), HasSubstr("is a count"));
  EXPECT_THAT(ProblemsOf("{sky: {uniform: [1, 0]}}"), HasSubstr("the first is larger"));
  EXPECT_THAT(ProblemsOf("{sky: {uniform: [0, 1], choice: [1]}}"), HasSubstr("keep one of them"));
  EXPECT_THAT(ProblemsOf("{appearance: {cube: {texture: marbel}}}"),
              HasSubstr("Did you mean 'marble'?"));
  EXPECT_THAT(ProblemsOf("{dynamics: {cube: {gain: 3}}}"), HasSubstr("is a factor"));
  EXPECT_THAT(ProblemsOf("{dynamics: {cube: {mass: {scale: {uniform: [0, 1]}}}}}"),
              HasSubstr("its factor is above 0"));
  EXPECT_THAT(ProblemsOf("{action_delay: 0.2}"), HasSubstr("an action comes every 0.066 s"));
  EXPECT_THAT(ProblemsOf("{pinned: {action_delay: 5}}"),
              HasSubstr("randomize.pinned.action_delay: can be 5 s, and an action comes every"));
  EXPECT_THAT(ProblemsOf("{pinned: {light/number: 2e9}}"), HasSubstr("between 0 and 4"));
}

TEST(RandomizeConfig, ARunWithoutTheBlockIsWrittenAsBefore) {
  RunConfig run;
  EXPECT_THAT(ToYaml(run), ::testing::Not(HasSubstr("randomize")));
  run.randomize.emplace();
  EXPECT_THAT(ToYaml(run), HasSubstr("randomize"));
}

TEST(RandomizeConfig, DescribesEachThingThatVaries) {
  EXPECT_THAT(
      Describe(Read("sky: {uniform: [0.3, 1]}\n"
                    "dynamics: {cube: {mass: {scale: {log_uniform: [0.5, 2]}}}}\n")),
      ::testing::ElementsAre("sky: 0.3 to 1, uniform", "cube: mass: x 0.5 to 2, log-uniform"));
}

}  // namespace
}  // namespace robocell
