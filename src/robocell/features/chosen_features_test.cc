#include "robocell/features/chosen_features.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/base/error.h"
#include "robocell/features/cell_features.h"
#include "robocell/features/own_features.h"
#include "robocell/robot/testing/robots.h"
#include "robocell/testing/count_allocations.h"
#include "robocell/testing/expect_throw.h"

namespace robocell::internal {
namespace {

using ::testing::ElementsAre;

class ChosenFeaturesTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    RegisterFeature("chosen_test_time",
                    {.column = {.shape = {2}, .units = "s"}, .lower = {0, 0}, .upper = {9, 9}},
                    [](const Scene& scene, std::span<double> out) {
                      out[0] = scene.time();
                      out[1] = 2 * scene.time();
                    });
  }
  Robot robot = RobotAlone(Rc7());
};

TEST_F(ChosenFeaturesTest, AreReadInTheChosenOrder) {
  Scene scene = robot.scene();
  ChosenFeatures chosen(scene, {robot}, {"chosen_test_time", "robots/*/arm/q*", "time"});
  const std::string path = "robots/" + robot.name() + "/arm/";
  EXPECT_THAT(chosen.keys(), ElementsAre("chosen_test_time", path + "qpos", path + "qvel", "time"));
  EXPECT_EQ(chosen.features()[0].column.name, "features/chosen_test_time");
  EXPECT_EQ(chosen.features()[0].column.units, "s");
  ASSERT_EQ(chosen.size(), 2 + 7 + 7 + 1);
  ASSERT_TRUE(scene.StepN(10).ok());
  std::vector<double> numbers(17);
  chosen.Read(numbers);
  EXPECT_EQ(numbers[1], 2 * scene.time());
  EXPECT_EQ(numbers[16], scene.time());
  // The oracle is the whole cell.
  CellFeatures cell(scene, {robot});
  std::span<const double> all = cell.ReadState();
  for (const Feature& feature : cell.observed().features()) {
    const auto part = all.first(static_cast<size_t>(feature.size()));
    if (feature.column.name == path + "qpos") {
      EXPECT_TRUE(std::equal(part.begin(), part.end(), numbers.begin() + 2));
    }
    if (feature.column.name == path + "qvel") {
      EXPECT_TRUE(std::equal(part.begin(), part.end(), numbers.begin() + 9));
    }
    all = all.subspan(part.size());
  }
}

TEST_F(ChosenFeaturesTest, ReadingAllocatesNothing) {
  ChosenFeatures chosen(robot.scene(), {robot}, {"time", "chosen_test_time", "robots/*"});
  ASSERT_GT(chosen.size(), 3 + 7 + 7);
  std::vector<double> numbers(static_cast<size_t>(chosen.size()));
  chosen.Read(numbers);
  const AllocationCount count;
  for (int i = 0; i < 10; ++i) chosen.Read(numbers);
  EXPECT_EQ(count.allocations(), 0);
}

TEST_F(ChosenFeaturesTest, RejectsUnknownNames) {
  ExpectThrow<NotFoundError>([&] { ChosenFeatures(robot.scene(), {robot}, {"chosen_test_tim"}); },
                             "no feature 'chosen_test_tim'");
  ExpectThrow<NotFoundError>([&] { ChosenFeatures(robot.scene(), {robot}, {"sensors/*"}); },
                             "no feature 'sensors/*'");
  EXPECT_EQ(ChosenFeatures(robot.scene(), {robot}, {}).size(), 0);
}

}  // namespace
}  // namespace robocell::internal
