// UdpArmServer: offers an arm to another program by datagrams, to be reached by UdpArm. The
// reference for drivers: the arm behind it may be a real one or a SimulatedArm, and `faults` make
// the network as bad as wanted.
//
//   UdpArmServer server(arm, "127.0.0.1:7071");
//   while (running) server.Poll();       // answers what arrived, sends the arm's state
//
// One program drives the arm: the first one that greets, until it is silent for `watchdog`. Then
// the arm holds where it is; so it does when told to hold. Damaged, repeated, late and foreign
// packets are dropped, and commands that are not finite too.
//
// It listens on this computer only, unless `remote`. Poll never waits. Errors: IoError if it cannot
// listen there, ArgumentError for an address beyond this computer without `remote`, and those of
// the arm. Threads: one at a time.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "robocell/hardware/arm_port.h"

namespace robocell {

struct LinkFaults {
  double latency = 0;  // of every packet in both directions, s
  double drop = 0;     // share of the packets that are lost
  double damage = 0;   // share in which a byte changes
  double repeat = 0;   // share that arrives twice, late
  uint64_t seed = 0;
};

struct UdpServerOptions {
  double rate = 250;      // states per second
  double watchdog = 0.2;  // s
  bool remote = false;
  std::string secret = {};
  LinkFaults faults = {};
};

class UdpArmServer {
 public:
  // The arm is kept as long as the server.
  UdpArmServer(std::shared_ptr<ArmPort> arm, const std::string& address,
               const UdpServerOptions& options = {});
  ~UdpArmServer();
  UdpArmServer(const UdpArmServer&) = delete;
  UdpArmServer& operator=(const UdpArmServer&) = delete;

  // Returns where it listens, with the port that was chosen for 0.
  std::string address() const;
  // Answers the packets that arrived by now(), and sends the state if it is due.
  void Poll();
  // Returns true while a program drives the arm.
  bool is_driven() const;
  int64_t dropped() const;  // packets
  ArmPort& arm() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robocell
