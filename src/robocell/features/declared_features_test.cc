#include "robocell/features/declared_features.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;

// Declares and observes the given features.
class Declaring final : public DeclaresFeatures {
 public:
  Declaring(std::vector<Feature> features, std::vector<double> numbers)
      : features_(std::move(features)), numbers_(std::move(numbers)) {}
  std::vector<Feature> signals() const override { return features_; }
  void Observe(const Scene& /*scene*/, std::span<double> out) const override {
    std::copy(numbers_.begin(), numbers_.end(), out.begin());
  }
  std::string PlaceOfHook(const char* method) const override {
    return "mine.py:7, in " + std::string(method);
  }

 private:
  std::vector<Feature> features_;
  std::vector<double> numbers_;
};

Scene SceneOfNothing() {
  return Scene::Build(
      {.name = "empty", .timestep = 0.002, .add_floor = false, .add_skybox = false});
}

DeclaredFeatures Declared(std::vector<Feature> features, std::vector<double> numbers = {}) {
  return {SceneOfNothing(), std::make_shared<Declaring>(std::move(features), std::move(numbers)),
          "task"};
}

TEST(DeclaredFeatures, HaveTheirPathAndDeclaration) {
  DeclaredFeatures features =
      Declared({{.column = {.name = "grid", .shape = {2, 2}, .units = "m", .names = {"x", "y"}}},
                {.column = {.name = "far"}, .lower = {0}, .upper = {1}}},
               {1, 2, 3, 4, 5});
  ASSERT_EQ(features.features().size(), 2u);
  EXPECT_EQ(features.features()[0].column.name, "task/grid");
  EXPECT_EQ(features.features()[0].column.units, "m");
  EXPECT_THAT(features.features()[0].column.shape, ElementsAre(2, 2));
  EXPECT_EQ(features.features()[1].role, FeatureRole::kObservation);
  std::vector<double> numbers(5);
  features.Read(numbers);
  EXPECT_THAT(numbers, ElementsAre(1, 2, 3, 4, 5)) << "beyond its range too: observations are cut";
}

TEST(DeclaredFeatures, RejectNonFiniteNumbersWithThePlace) {
  DeclaredFeatures features = Declared({{.column = {.name = "odd"}}}, {std::nan("")});
  std::vector<double> numbers(1);
  ExpectThrow<HookError>(
      [&] { features.Read(numbers); },
      "feature 'task/odd' is nan at t = 0.000 s; features must be finite (mine.py:7, in observe)");
}

TEST(DeclaredFeatures, RejectsInvalidFeatures) {
  ExpectThrow<HookError>([] { Declared({{.column = {.name = ""}}}); }, "needs a name");
  ExpectThrow<HookError>([] { Declared({{.column = {.name = "a", .type = ColumnType::kBool}}}); },
                         "signal 'a' must be float64, not bool (mine.py:7, in signals)");
  ExpectThrow<HookError>(
      [] { Declared({{.column = {.name = "a"}, .role = FeatureRole::kAction}}); },
      "signal 'a' must be an observation, privileged or not, got action");
  ExpectThrow<HookError>(
      [] {
        Declared({{.column = {.name = "a"}, .lower = {0, 0}, .upper = {1, 1}}});
      },
      "feature 'a'");
}

TEST(DeclaredFeatures, AreEmptyWithoutATask) {
  DeclaredFeatures features(SceneOfNothing(), nullptr, "task");
  EXPECT_EQ(features.size(), 0);
  features.Read({});
}

}  // namespace
}  // namespace robocell
