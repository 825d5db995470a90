#include "robocell/features/own_features.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

void WriteNothing(const Scene&, std::span<double>) {}

TEST(OwnFeatures, AreKnownByTheirNames) {
  RegisterFeature("clock_of_test", {}, &WriteNothing);
  EXPECT_THAT(OwnFeatures(), Contains("clock_of_test"));
  EXPECT_TRUE(IsOwnFeature("clock_of_test"));
  EXPECT_FALSE(IsOwnFeature("clok_of_test"));
  EXPECT_NO_THROW(RegisterFeature("clock_of_test", {}, &WriteNothing, /*replace=*/true));
}

TEST(OwnFeatures, MistakesAreRefusedWhenTheyAreRegistered) {
  RegisterFeature("taken_of_test", {}, &WriteNothing);
  ExpectThrow<ArgumentError>([] { RegisterFeature("taken_of_test", {}, &WriteNothing); },
                             "feature 'taken_of_test' is registered already");
  ExpectThrow<ArgumentError>([] { RegisterFeature("a/b", {}, &WriteNothing); }, "contains '/'");
  ExpectThrow<ArgumentError>([] { RegisterFeature("none", {}, {}); }, "needs a function");
  ExpectThrow<ArgumentError>(
      [] { RegisterFeature("count", {.column = {.type = ColumnType::kInt32}}, &WriteNothing); },
      "feature 'count' must be float64, not int32");
  ExpectThrow<NotFoundError>([] { CodeOfFeatures({"takn_of_test"}); },
                             "Did you mean 'taken_of_test'?");
}

TEST(OwnFeatures, NameTheFilesOfTheirCode) {
  const auto files = [] { return std::vector<std::string>{"my_features.py"}; };
  RegisterFeature("with_code_of_test", {}, &WriteNothing, false, {.files = files});
  RegisterFeature("without_code_of_test", {}, &WriteNothing);
  EXPECT_THAT(CodeOfFeatures({"with_code_of_test", "without_code_of_test"}),
              ElementsAre("my_features.py"));
  EXPECT_THAT(CodeOfFeatures({}), IsEmpty());
}

TEST(OwnFeatureSource, ReadsEachFunctionIntoItsPart) {
  RegisterFeature("pair_of_test", {.column = {.shape = {2}}},
                  [](const Scene&, std::span<double> out) { out[0] = 1, out[1] = 2; });
  RegisterFeature("time_of_test", {},
                  [](const Scene& scene, std::span<double> out) { out[0] = scene.time(); });
  const Robot robot = RobotAlone(Rc7());
  OwnFeatureSource source(robot.scene(), {"time_of_test", "pair_of_test"});
  std::vector<double> numbers(3, -1);
  source.Read(numbers);
  EXPECT_THAT(numbers, ElementsAre(robot.scene().time(), 1, 2));
}

}  // namespace
}  // namespace robocell
