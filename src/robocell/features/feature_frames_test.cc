#include "robocell/features/feature_frames.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "robocell/base/hook_error.h"
#include "robocell/features/declared_features.h"
#include "robocell/features/own_features.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

using ::testing::HasSubstr;

class FeatureFrames : public ::testing::Test {
 protected:
  const Robot robot = RobotAlone(Rc7());
  const Scene scene = robot.scene();
};

TEST_F(FeatureFrames, AreThoseOfTheRobotsAndElementsOfTheScene) {
  const std::string name = robot.name();
  for (const std::string& frame :
       {std::string(), std::string("world"), std::string("root frame"),
        std::string("shared base frame"), "base of " + name, "TCP of " + name})
    EXPECT_EQ(WhyNoFrame(scene, frame), "");
  EXPECT_EQ(WhyNoFrame(scene, "body 'world'"), "");
}

TEST_F(FeatureFrames, ThatNameNothingAreRejectedWithTheNearestNames) {
  EXPECT_THAT(WhyNoFrame(scene, "wrld"), HasSubstr("Did you mean 'world'?"));
  EXPECT_THAT(WhyNoFrame(scene, "TPC of " + robot.name()),
              HasSubstr("Did you mean 'TCP of " + robot.name() + "'?"));
  EXPECT_THAT(WhyNoFrame(scene, "body 'wrld'"), HasSubstr("Did you mean 'body 'world''?"));
}

TEST_F(FeatureFrames, AreRequiredOfRegisteredFeatures) {
  RegisterFeature("frame_of_test", {.column = {.frame = "wrold"}},
                  [](const Scene&, std::span<double> out) { out[0] = 1; }, true,
                  {.files = {}, .place = [] { return "mine.py:3, in frame_of_test"; }});
  ExpectThrow<HookError>([&] { OwnFeatureSource(scene, {"frame_of_test"}); },
                         "feature 'features/frame_of_test'");
  ExpectThrow<HookError>([&] { OwnFeatureSource(scene, {"frame_of_test"}); },
                         "Did you mean 'world'? (mine.py:3, in frame_of_test)");
}

TEST_F(FeatureFrames, AreRequiredOfSignals) {
  struct Declaring final : DeclaresFeatures {
    std::vector<Feature> signals() const override {
      return {{.column = {.name = "goal", .frame = "wrold"}}};
    }
    void Observe(const Scene&, std::span<double>) const override {}
  };
  ExpectThrow<HookError>([&] { DeclaredFeatures(scene, std::make_shared<Declaring>(), "task"); },
                         "signal 'goal': no frame 'wrold'");
}

}  // namespace
}  // namespace robocell::internal
