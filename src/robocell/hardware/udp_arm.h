// UdpArm: the port of an arm that is reached by datagrams, as UdpArmServer serves it
// (udp_arm_server.h). The packets are described in arm_packet.h.
//
//   UdpArm arm("127.0.0.1:7071");   // asks the arm for its joints and limits
//
// Damaged, repeated, late and foreign packets are dropped. An address that is not of this computer
// needs `remote`: packets are not encrypted, and without `secret` anyone in the network can send
// some. Even with it, who recorded packets can send those of an earlier program again once the arm
// is not driven; use a network that you trust.
//
// Read greets an arm that is silent, so that it measures for a program that was busy elsewhere or
// sends no commands.
//
// Errors: IoError if the arm does not answer in time. Afterwards nothing is an error: an arm that
// is gone is silent, and the SafetyGate's watch-dog stops the link. Threads: one at a time.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "robocell/hardware/arm_port.h"

namespace robocell {

struct UdpArmOptions {
  double timeout = 2;       // for the arm's first answer, s
  bool remote = false;      // the address may be of another computer
  std::string secret = {};  // the same as the server's
};

class UdpArm final : public ArmPort {
 public:
  explicit UdpArm(const std::string& address, const UdpArmOptions& options = {});
  ~UdpArm() override;

  std::string name() const override;
  std::vector<std::string> joint_names() const override;
  ArmLimits limits() const override;
  bool Read(ArmMeasurement& out) override;
  void Send(const ArmCommand& command) override;
  bool takes_forces() const override;
  void Hold() override;
  // Returns the packets that were dropped so far.
  int64_t dropped() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robocell
