#include "robocell/hardware/udp_arm.h"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/hardware/arm_packet.h"
#include "robocell/hardware/arm_port.h"
#include "robocell/hardware/testing/fake_arm.h"
#include "robocell/hardware/udp_arm_server.h"
#include "robocell/hardware/udp_socket.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

struct Served {
  explicit Served(const UdpServerOptions& options = {})
      : arm(std::make_shared<FakeArm>()), server(arm, "127.0.0.1:0", options) {}
  // A turn of the server's loop.
  void Poll(double seconds = 0.01) {
    arm->clock += seconds;
    server.Poll();
  }
  std::shared_ptr<FakeArm> arm;
  UdpArmServer server;
};

ArmCommand CommandTo(double q) { return {.pos = {q, -q}, .vel = {0, 0}}; }

TEST(UdpArm, DescribesMeasuresAndCommandsTheArmBehind) {
  Served served;
  const auto arm = Connect(served.server);
  EXPECT_EQ(arm->joint_names(), served.arm->joints);
  EXPECT_EQ(arm->limits(), served.arm->bounds);
  arm->Send(CommandTo(0.3));
  served.Poll();
  served.Poll();
  ArmMeasurement measured;
  ASSERT_TRUE(arm->Read(measured));
  EXPECT_EQ(measured.pos, (std::vector<double>{0.3, -0.3}));
  EXPECT_EQ(measured.opening, 1);
  EXPECT_EQ(measured.time, served.arm->clock);
  EXPECT_FALSE(arm->Read(measured)) << "nothing new";
}

TEST(UdpArm, ForcesReachAnArmThatTakesThemAndNoOther) {
  for (const bool takes : {true, false}) {
    Served served;
    served.arm->takes = takes;
    const auto arm = Connect(served.server);
    EXPECT_EQ(arm->takes_forces(), takes);
    arm->Send({.pos = {0.1, 0.2}, .vel = {0, 0}, .force = {3, -4}});
    served.Poll();
    const std::vector<double> expected = takes ? std::vector<double>{3, -4} : std::vector<double>{};
    EXPECT_EQ(served.arm->forces, expected);
    EXPECT_EQ(served.arm->sent, takes ? 1 : 0);
    arm->Send(CommandTo(0.3));
    served.Poll();
    EXPECT_TRUE(served.arm->forces.empty());
    EXPECT_EQ(served.arm->at.pos[0], 0.3);
  }
}

TEST(UdpArm, HoldsTheArmWhenItsProgramIsSilentOrKilled) {
  Served served({.watchdog = 0.1});
  auto arm = Connect(served.server);
  arm->Send(CommandTo(0.3));
  served.Poll();
  arm.reset();  // as a kill: nothing says good-bye
  for (int i = 0; i < 20; ++i) served.Poll();
  EXPECT_EQ(served.arm->held, 1);
  EXPECT_FALSE(served.server.is_driven());
  const auto next = Connect(served.server);
  next->Send(CommandTo(0.1));
  served.Poll();
  EXPECT_EQ(served.arm->at.pos[0], 0.1) << "another program may drive it then";
}

TEST(UdpArm, IsMeasuredAgainAfterItsProgramWasBusy) {
  Served served({.watchdog = 0.1});
  const auto arm = Connect(served.server);
  for (int i = 0; i < 20; ++i) served.Poll();
  ASSERT_FALSE(served.server.is_driven());
  std::this_thread::sleep_for(std::chrono::milliseconds(60));
  ArmMeasurement measured;
  while (arm->Read(measured)) continue;  // old ones
  std::this_thread::sleep_for(std::chrono::milliseconds(60));
  (void)arm->Read(measured);
  served.Poll();
  served.Poll();
  ASSERT_TRUE(arm->Read(measured));
  EXPECT_EQ(measured.time, served.arm->clock);
}

TEST(UdpArm, IsDrivenByOneProgram) {
  Served served;
  const auto first = Connect(served.server);
  ExpectThrow<IoError>([&] { Connect(served.server, {.timeout = 0.1}); }, "no arm answers");
  first->Send(CommandTo(0.2));
  served.Poll();
  EXPECT_EQ(served.arm->at.pos[0], 0.2);
}

TEST(UdpArm, NeedsTheSecret) {
  Served served({.secret = "sesame"});
  ExpectThrow<IoError>([&] { Connect(served.server, {.timeout = 0.1}); }, "no arm answers");
  EXPECT_NE(Connect(served.server, {.secret = "sesame"}), nullptr);
}

TEST(UdpArm, StaysOnThisComputerUnlessAsked) {
  ExpectThrow<ArgumentError>([] { const UdpArm arm("192.0.2.1:7071"); }, "remote=true");
  ExpectThrow<ArgumentError>(
      [] { const UdpArmServer server(std::make_shared<FakeArm>(), "0.0.0.0:0"); }, "remote=true");
  for (const double timeout : {0.05, std::nan("")}) {
    ExpectThrow<IoError>([&] { const UdpArm arm("127.0.0.1:9", {.timeout = timeout}); },
                         "no arm answers at udp 127.0.0.1:9");
  }
}

TEST(UdpArm, ObeysTheNewestOfPacketsThatWereLostDamagedRepeatedAndLate) {
  Served served({.watchdog = 5, .faults = {.drop = 0.2, .damage = 0.2, .repeat = 0.3, .seed = 4}});
  const auto arm = Connect(served.server, {.timeout = 10});
  double last = 0;
  for (int i = 1; i <= 200; ++i) {
    arm->Send(CommandTo(0.001 * i));
    served.Poll();
    EXPECT_GE(served.arm->at.pos[0], last) << "never an older one";
    last = served.arm->at.pos[0];
    ArmMeasurement measured;
    if (arm->Read(measured)) EXPECT_EQ(measured.pos.size(), 2);
  }
  EXPECT_GT(last, 0.18);
  EXPECT_GT(served.server.dropped(), 20);
  EXPECT_GT(arm->dropped(), 10);
}

TEST(UdpArm, IsNotMovedByNonsenseOrFloods) {
  Served served;
  const auto arm = Connect(served.server);
  arm->Send(CommandTo(std::nan("")));
  arm->Send({.pos = {1, 1}, .vel = {INFINITY, 0}});
  internal::UdpSocket stranger(internal::ParseAddress("127.0.0.1:0"));
  const auto there = internal::ParseAddress(served.server.address());
  std::vector<std::byte> bytes;
  internal::ArmPacket packet{.kind = internal::PacketKind::kCommand,
                             .session = 1,
                             .sequence = 99,
                             .joints = 2,
                             .values = {1, 1, 0, 0, 0}};
  internal::Encode(packet, internal::PacketKey(""), bytes);
  for (int i = 0; i < 300; ++i) stranger.Send(bytes, there);
  for (int i = 0; i < 20; ++i) served.Poll(0.001);
  EXPECT_EQ(served.arm->sent, 0);
  arm->Send(CommandTo(0.2));
  served.Poll();
  EXPECT_EQ(served.arm->at.pos[0], 0.2);
}

TEST(UdpArm, HoldsWhenAsked) {
  Served served;
  const auto arm = Connect(served.server);
  arm->Send(CommandTo(0.2));
  arm->Hold();
  served.Poll();
  EXPECT_EQ(served.arm->held, 1);
}

}  // namespace
}  // namespace robocell
