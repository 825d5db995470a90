// Tests the tolerances of arrived joints.
#include "robocell/robot/arrival.h"

#include <gtest/gtest.h>

#include "robocell/robot/testing/robots.h"

namespace robocell::internal {
namespace {

TEST(Arrival, OfSlidesIsATenthOfHinges) {
  ModelFolder folder;
  RobotConfig config{.name = "rail", .model = folder.Write("rail", R"(
    <worldbody><body name="base"><geom size="0.1"/>
      <body name="cart"><joint name="slide" type="slide" axis="1 0 0"/><geom size="0.1"/>
        <body name="arm" pos="0 0 0.1"><joint name="turn"/><geom size="0.1"/><site name="tcp"/></body>
      </body></body></worldbody>
    <actuator><position name="s" joint="slide" kp="100"/><position name="t" joint="turn" kp="100"/>
    </actuator>)")};
  config.move_groups["arm"] = {.kind = MoveGroupKind::kArm,
                               .joints = {"slide", "turn"},
                               .actuators = {"s", "t"},
                               .leaf = ElementRef{.kind = ElementKind::kSite, .name = "tcp"}};
  config.arrival_tolerance = 0.02;
  const std::vector<double> tolerances = ArrivalTolerances(RobotAlone(config), "arm");
  EXPECT_EQ(tolerances, (std::vector<double>{0.002, 0.02}));

  const std::vector<double> target = {0.5, 1};
  EXPECT_TRUE(AreWithin(std::vector{0.5019, 0.981}, target, tolerances));
  EXPECT_FALSE(AreWithin(std::vector{0.5021, 1.0}, target, tolerances));
  EXPECT_FALSE(AreWithin(std::vector{0.5, 1.021}, target, tolerances));
  EXPECT_TRUE(AreWithin(std::vector{0.5021, 1.021}, target, tolerances, 2));
}

}  // namespace
}  // namespace robocell::internal
