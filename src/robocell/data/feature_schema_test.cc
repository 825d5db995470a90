#include "robocell/data/feature_schema.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <string>

#include "robocell/base/error.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

FeatureSchema Two() {
  FeatureSchema schema;
  schema.Add({.column = {.name = "robots/a/qpos",
                         .shape = {2},
                         .units = "rad",
                         .frame = "world",
                         .names = {"j1", "j2"},
                         .description = "Joints."},
              .lower = {-1, -std::numeric_limits<double>::infinity()},
              .upper = {1, std::numeric_limits<double>::infinity()},
              .source = "robot a"});
  schema.Add({.column = {.name = "phase", .type = ColumnType::kInt32, .values = {"go", "stop"}},
              .role = FeatureRole::kLabel});
  return schema;
}

TEST(FeatureSchema, KnowsItsFeaturesByNameAndRole) {
  const FeatureSchema schema = Two();
  EXPECT_EQ(schema.size(), 3);
  EXPECT_EQ(schema.Find("phase").role, FeatureRole::kLabel);
  EXPECT_THAT(schema.Names(FeatureRole::kObservation), ElementsAre("robots/a/qpos"));
  ExpectThrow<NotFoundError>([&] { schema.Find("phse"); }, "Did you mean 'phase'?");
}

TEST(FeatureSchema, RoundTripsThroughJson) {
  const FeatureSchema schema = Two(), again = FeatureSchema::FromJson(schema.ToJson());
  EXPECT_EQ(again.DifferenceFrom(schema), "");
  EXPECT_EQ(again.ToJson(), schema.ToJson());
  EXPECT_EQ(again.Find("robots/a/qpos").lower, schema.Find("robots/a/qpos").lower);
  EXPECT_EQ(again.Find("robots/a/qpos").upper, schema.Find("robots/a/qpos").upper);
  EXPECT_EQ(again.Find("phase").column.values, schema.Find("phase").column.values);
  EXPECT_TRUE(FeatureSchema::FromJson("[]").empty());
}

TEST(FeatureSchema, RejectsAnInvalidSchemaByFeatureAndField) {
  const auto refuse = [](const char* text, const char* why) {
    ExpectThrow<SpecError>([&] { FeatureSchema::FromJson(text); }, why);
  };
  refuse("{", "features: expected a list of features in JSON");
  refuse("[3]", "features[0]: expected an object");
  refuse(R"([{"role": "label"}])", "features[0], field 'name': is missing");
  refuse(R"([{"name": "a", "dtype": "float64", "shape": []}])",
         "feature 'a', field 'role': is missing");
  refuse(R"([{"name": "a", "role": "lable", "dtype": "float64", "shape": []}])",
         "Did you mean 'label'?");
  refuse(R"([{"name": "a", "role": "label", "dtype": "float64", "shape": [0]}])",
         "feature 'a', field 'shape': expected sizes of at least 1, found [0]");
  refuse(R"([{"name": "a", "role": "label", "dtype": "float64", "shape": [99999999, 99999999]}])",
         "field 'shape'");
  refuse(R"([{"name": "a", "role": "label", "dtype": "float64", "shape": [], "units": "m"}])",
         "feature 'a', field 'units': is unknown. Fields: name, dtype");
  refuse(R"([{"name": "a", "role": "label", "dtype": "float64", "shape": [2], "lower": [0]}])",
         "feature 'a': its range has 1 lower bound and 0 upper bounds");
}

TEST(FeatureSchema, RejectsImpossibleFeatures) {
  FeatureSchema schema = Two();
  ExpectThrow<ArgumentError>([&] { schema.Add({.column = {.name = "phase"}}); },
                             "feature 'phase' is declared twice");
  ExpectThrow<ArgumentError>([&] { schema.Add({}); }, "needs a name");
  ExpectThrow<ArgumentError>(
      [&] { schema.Add({.column = {.name = "b"}, .lower = {1}, .upper = {0}}); },
      "feature 'b': the lower bound of number 0 is 1, above 0");
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double bound : {kInfinity, -kInfinity}) {
    ExpectThrow<ArgumentError>(
        [&] { schema.Add({.column = {.name = "b"}, .lower = {bound}, .upper = {bound}}); },
        "feature 'b': the range of number 0");
  }
  for (const int64_t size : {0, -1}) {
    ExpectThrow<ArgumentError>(
        [&] {
          schema.Add({.column = {.name = "b", .shape = {3, size}}});
        },
        "feature 'b': its shape [3, " + std::to_string(size) + "] has a size of");
  }
}

TEST(FeatureSchema, DescribesTheFirstDifference) {
  const FeatureSchema schema = Two();
  FeatureSchema other;
  other.Add(schema.features()[0]);
  EXPECT_EQ(schema.DifferenceFrom(other, "in the dataset", "in the cell"),
            "feature 'phase' is in the dataset and not in the cell");
  EXPECT_EQ(other.DifferenceFrom(schema), "feature 'phase' is there and not here");
  Feature degrees = schema.features()[1];
  degrees.column.shape = {3};
  other.Add(degrees);
  EXPECT_THAT(schema.DifferenceFrom(other),
              HasSubstr("feature 'phase' is label int32 () here and label int32 (3) there"));
  FeatureSchema renamed;
  Feature joints = schema.features()[0];
  joints.column.names = {"j2", "j1"};
  renamed.Add(joints);
  renamed.Add(schema.features()[1]);
  EXPECT_THAT(schema.DifferenceFrom(renamed),
              HasSubstr("has the numbers j1, j2 here and j2, j1 there"));
  Feature wider = schema.features()[0];
  wider.lower = wider.upper = {};
  FeatureSchema free;
  free.Add(schema.features()[1]);
  free.Add(wider);
  EXPECT_EQ(schema.DifferenceFrom(free), "") << "neither order nor ranges count";
}

}  // namespace
}  // namespace robocell
