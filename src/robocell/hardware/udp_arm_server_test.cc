#include "robocell/hardware/udp_arm_server.h"

#include <gtest/gtest.h>

#include <memory>

#include "robocell/base/error.h"
#include "robocell/hardware/arm_port.h"
#include "robocell/hardware/testing/fake_arm.h"

namespace robocell {
namespace {

TEST(UdpArmServer, SendsStatesAtItsRateWhileItIsDriven) {
  const auto arm = std::make_shared<FakeArm>();
  UdpArmServer server(arm, "127.0.0.1:0", {.rate = 100, .watchdog = 5});
  const auto client = Connect(server);
  ArmMeasurement measured;
  (void)client->Read(measured);
  int states = 0;
  for (int i = 0; i < 100; ++i) {
    arm->clock += 0.005;
    server.Poll();
    states += client->Read(measured) ? 1 : 0;
  }
  EXPECT_NEAR(states, 50, 2);
}

TEST(UdpArmServer, DelaysPacketsByTheLatency) {
  const auto arm = std::make_shared<FakeArm>();
  UdpArmServer prompt(arm, "127.0.0.1:0", {.watchdog = 5});
  (void)Connect(prompt);
  UdpArmServer late(arm, "127.0.0.1:0", {.watchdog = 5, .faults = {.latency = 1e-9}});
  EXPECT_THROW(Connect(late, {.timeout = 0.05}), IoError) << "its clock stands still";
  arm->clock += 1e-3;
  late.Poll();
  EXPECT_TRUE(late.is_driven());
}

TEST(UdpArmServer, RejectsOptionsThatCannotWork) {
  const auto arm = std::make_shared<FakeArm>();
  EXPECT_THROW(UdpArmServer(arm, "127.0.0.1:0", {.rate = 0}), ArgumentError);
  EXPECT_THROW(UdpArmServer(arm, "127.0.0.1:0", {.watchdog = -1}), ArgumentError);
  EXPECT_THROW(UdpArmServer(nullptr, "127.0.0.1:0"), ArgumentError);
}

}  // namespace
}  // namespace robocell
