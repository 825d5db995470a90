#include "robocell/hardware/udp_arm_server.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/hash.h"
#include "robocell/hardware/arm_packet.h"
#include "robocell/hardware/arm_port.h"
#include "robocell/hardware/testing/fake_arm.h"
#include "robocell/hardware/udp_arm_server.h"
#include "robocell/hardware/udp_socket.h"

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

TEST(UdpArmServer, IsNotKeptDrivenByAGreetingThatIsRepeated) {
  const auto arm = std::make_shared<FakeArm>();
  UdpArmServer server(arm, "127.0.0.1:0", {.watchdog = 0.1});
  const auto there = internal::ParseAddress(server.address());
  internal::UdpSocket driver(internal::ParseAddress("127.0.0.1:0"));
  internal::UdpSocket stranger(internal::ParseAddress("127.0.0.1:0"));
  const Hash128 key = internal::PacketKey("");
  std::vector<std::byte> hello, command;
  internal::Encode({.session = 7, .sequence = 1}, key, hello);
  internal::Encode({.kind = internal::PacketKind::kCommand,
                    .session = 7,
                    .sequence = 2,
                    .joints = 2,
                    .values = {0.1, 0.1, 0, 0, INFINITY}},
                   key, command);
  driver.Send(hello, there);
  driver.Send(command, there);
  server.Poll();
  EXPECT_EQ(arm->sent, 0) << "an opening that is not finite";
  EXPECT_EQ(server.dropped(), 1);
  command.clear();
  internal::Encode({.kind = internal::PacketKind::kCommand,
                    .session = 7,
                    .sequence = 3,
                    .joints = 2,
                    .values = {0.1, 0.1, 0, 0, 1}},
                   key, command);
  driver.Send(command, there);
  server.Poll();
  EXPECT_EQ(arm->sent, 1);
  for (int i = 0; i < 20; ++i) {
    arm->clock += 0.01;
    stranger.Send(hello, there);
    server.Poll();
  }
  EXPECT_EQ(arm->held, 1);
}

TEST(UdpArmServer, RejectsOptionsThatCannotWork) {
  const auto arm = std::make_shared<FakeArm>();
  EXPECT_THROW(UdpArmServer(arm, "127.0.0.1:0", {.rate = 0}), ArgumentError);
  EXPECT_THROW(UdpArmServer(arm, "127.0.0.1:0", {.watchdog = -1}), ArgumentError);
  EXPECT_THROW(UdpArmServer(nullptr, "127.0.0.1:0"), ArgumentError);
}

}  // namespace
}  // namespace robocell
