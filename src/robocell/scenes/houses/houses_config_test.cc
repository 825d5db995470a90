#include "robocell/scenes/houses/houses_config.h"

#include <gtest/gtest.h>

#include <string>

#include "robocell/spec/yaml.h"

namespace robocell {
namespace {

TEST(HousesConfig, RoundTripsThroughYaml) {
  const HousesScenes fields{.dataset = "procthor-10k", .split = "val", .ceiling = false};
  const auto back = FromYamlUnchecked<HousesScenes>(ToYaml(fields));
  EXPECT_EQ(back.dataset, fields.dataset);
  EXPECT_EQ(back.split, fields.split);
  EXPECT_FALSE(back.ceiling);
  EXPECT_FALSE(back.root);
}

TEST(HousesConfig, BuiltInHousesHaveNoSplits) {
  Problems problems;
  HousesScenes{.split = "val"}.Validate(problems);
  EXPECT_FALSE(problems.empty());
  Problems none;
  HousesScenes{.root = "houses", .split = "val"}.Validate(none);
  EXPECT_TRUE(none.empty());
}

}  // namespace
}  // namespace robocell
