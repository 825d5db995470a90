#include "robocell/spec/tool_frame_spec.h"

#include <gtest/gtest.h>

#include <string>

#include "robocell/base/error.h"
#include "robocell/spec/validate.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

TEST(ForceTorqueSensorSpec, ItsNameStandsForThePair) {
  const ForceTorqueSensorSpec wrist{.name = "wrist_ft"};
  EXPECT_EQ(wrist.force(), "wrist_ft_force");
  EXPECT_EQ(wrist.torque(), "wrist_ft_torque");
  const ForceTorqueSensorSpec own{.name = "wrist_ft", .force_sensor = "f", .torque_sensor = "t"};
  EXPECT_EQ(own.force() + own.torque(), "ft");
}

TEST(ToolFrameSpec, ASensorNeedsAName) {
  ToolFrameSpec tool;
  RequireValid(tool, "the tool");
  tool.ft_sensors.push_back({.frame_site = "wrist"});
  ExpectThrow<SpecError>([&] { RequireValid(tool, "the tool"); },
                         "is required: force-torque sensors are looked up by name; `wrist_ft` "
                         "stands for the pair wrist_ft_force and wrist_ft_torque");
}

TEST(ToolFrameSpec, SensorsDoNotShareAName) {
  ToolFrameSpec tool;
  tool.ft_sensors.push_back({.name = "wrist_ft"});
  tool.ft_sensors.push_back({.name = "base_ft"});
  RequireValid(tool, "the tool");
  tool.ft_sensors.push_back({.name = "wrist_ft"});
  ExpectThrow<SpecError>([&] { RequireValid(tool, "the tool"); },
                         "name 'wrist_ft' is also that of ft_sensors[0]");
}

}  // namespace
}  // namespace robocell
