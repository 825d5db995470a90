// For tests only: an arm without a body that is where it was commanded, with a clock that tests
// move.
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "robocell/hardware/arm_port.h"
#include "robocell/hardware/udp_arm.h"
#include "robocell/hardware/udp_arm_server.h"

namespace robocell {

struct FakeArm final : ArmPort {
  explicit FakeArm(std::vector<std::string> names = {"shoulder", "elbow"})
      : joints(std::move(names)) {
    const size_t n = joints.size();
    at = {.pos = std::vector<double>(n),
          .vel = std::vector<double>(n),
          .force = std::vector<double>(n),
          .opening = 1};
    bounds = {.lower = std::vector<double>(n, -3),
              .upper = std::vector<double>(n, 3),
              .velocity = std::vector<double>(n, 2),
              .acceleration = std::vector<double>(n, 10),
              .force = std::vector<double>(n, 100)};
  }
  std::string name() const override { return "fake arm"; }
  std::vector<std::string> joint_names() const override { return joints; }
  ArmLimits limits() const override { return bounds; }
  bool Read(ArmMeasurement& out) override {
    if (!speaks) return false;
    out = at;
    out.time = clock;
    return true;
  }
  void Send(const ArmCommand& command) override {
    ++sent;
    at.pos = command.pos;
    forces = command.force;
  }
  bool takes_forces() const override { return takes; }
  void Hold() override { ++held; }
  double now() const override { return clock; }
  void WaitUntil(double time) override { clock = time > clock ? time : clock; }

  std::vector<std::string> joints;
  ArmMeasurement at;
  ArmLimits bounds;
  double clock = 10;
  bool speaks = true, takes = false;
  std::vector<double> forces;  // of the last command
  int sent = 0, held = 0;
};

// Connects to a server, which another thread polls until then.
inline std::unique_ptr<UdpArm> Connect(UdpArmServer& server, const UdpArmOptions& options = {}) {
  std::unique_ptr<UdpArm> arm;
  std::atomic<bool> is_done = false;
  std::thread polling([&] {
    while (!is_done) {
      server.Poll();
      std::this_thread::yield();
    }
  });
  try {
    arm = std::make_unique<UdpArm>(server.address(), options);
  } catch (...) {
    is_done = true;
    polling.join();
    throw;
  }
  is_done = true;
  polling.join();
  return arm;
}

}  // namespace robocell
