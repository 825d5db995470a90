#include "robocell/features/feature_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "robocell/base/hook_error.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;

// A number and a row of two, of a user's code or not.
class TwoFeatures : public FeatureSource {
 public:
  TwoFeatures(std::array<double, 3> numbers, bool is_users)
      : FeatureSource(Scene::Build(EmptyScene())), numbers_(numbers), is_users_(is_users) {
    Add({.column = {.name = "one"}});
    Add({.column = {.name = "pair", .shape = {2}}});
  }

 private:
  void ReadNumbers(std::span<double> out) override { std::ranges::copy(numbers_, out.begin()); }
  bool is_users() const override { return is_users_; }
  std::string PlaceOf(size_t feature) const override {
    return "my.py:" + std::to_string(10 + feature) + ", in read";
  }

  std::array<double, 3> numbers_;
  bool is_users_;
};

std::vector<double> Read(TwoFeatures source) {
  std::vector<double> out(static_cast<size_t>(source.size()));
  source.Read(out);
  return out;
}

TEST(FeatureSource, WritesItsFeaturesOneAfterAnother) {
  EXPECT_THAT(Read(TwoFeatures({1, 2, 3}, true)), ElementsAre(1, 2, 3));
}

TEST(FeatureSource, AUsersNumbersMustBeFinite) {
  ExpectThrow<HookError>(
      [] {
        Read(TwoFeatures({1, 2, NAN}, true));
      },
      "feature 'pair' is nan at t = 0.000 s; features must be finite "
      "(my.py:11, in read)");
  ExpectThrow<HookError>(
      [] {
        Read(TwoFeatures({INFINITY, 2, 3}, true));
      },
      "feature 'one' is inf at t = 0.000 s");
  EXPECT_TRUE(std::isnan(Read(TwoFeatures({NAN, 2, 3}, false))[0])) << "the engine's are recorded";
}

TEST(FeatureSource, APoseIsAPositionAndAQuaternion) {
  const Feature feature = PoseFeature("cube", "world", FeatureRole::kPrivileged, "object", "");
  EXPECT_EQ(feature.size(), kPoseNumbers);
  EXPECT_THAT(feature.column.names, ElementsAre("x", "y", "z", "qx", "qy", "qz", "qw"));
  std::array<double, kPoseNumbers> numbers{};
  PutPose(Pose::FromRpy({1, 2, 3}, {0, 0, std::acos(0.0)}), numbers);
  const double half = std::sqrt(0.5);
  const std::array<double, kPoseNumbers> expected = {1, 2, 3, 0, 0, half, half};
  for (size_t i = 0; i < numbers.size(); ++i) EXPECT_NEAR(numbers[i], expected[i], 1e-12) << i;
}

}  // namespace
}  // namespace robocell
