#include "robocell/hardware/udp_arm_server.h"

#include <netinet/in.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/hash.h"
#include "robocell/base/rng.h"
#include "robocell/hardware/arm_packet.h"
#include "robocell/hardware/arm_port.h"
#include "robocell/hardware/udp_socket.h"

namespace robocell {
namespace {

using internal::ArmPacket;
using internal::PacketKind;

constexpr int kMostAtOnce = 64;
constexpr size_t kMostWaiting = 4096;

sockaddr_in ListeningAddress(const std::string& address, bool remote) {
  const sockaddr_in parsed = internal::ParseAddress(address);
  if (remote || internal::IsLoopback(parsed)) return parsed;
  throw ArgumentError(fmt::format(
      "{} can be reached by other computers, whose programs could move the arm; pass remote=true "
      "if they may, and a secret",
      internal::ToString(parsed)));
}

}  // namespace

struct UdpArmServer::Impl {
  // A datagram on its way, in or out.
  struct Late {
    double due;
    bool comes_in;
    sockaddr_in peer;
    std::vector<std::byte> bytes;
  };

  Impl(std::shared_ptr<ArmPort> behind, const std::string& text, const UdpServerOptions& given)
      : arm(std::move(behind)),
        options(given),
        socket(ListeningAddress(text, given.remote)),
        key(internal::PacketKey(given.secret)),
        rng(Rng::Stream(given.faults.seed, "faults of a link")),
        joints(arm->joint_names()),
        limits(arm->limits()) {}

  bool Chance(double share) { return share > 0 && rng.Uniform(0, 1) < share; }

  // Lets a datagram pass the network with its faults.
  void Pass(bool comes_in, const sockaddr_in& peer, std::span<const std::byte> bytes, double now) {
    const LinkFaults& faults = options.faults;
    if (Chance(faults.drop) || late.size() >= kMostWaiting) return;
    Late on_its_way{now + faults.latency, comes_in, peer, {bytes.begin(), bytes.end()}};
    if (Chance(faults.damage) && !bytes.empty()) {
      const auto at = static_cast<size_t>(rng.Uniform(0, static_cast<double>(bytes.size())));
      on_its_way.bytes[std::min(at, bytes.size() - 1)] ^= std::byte{0x5a};
    }
    if (Chance(faults.repeat)) {
      late.push_back(on_its_way);
      late.back().due += faults.latency + 0.01;
    }
    late.push_back(std::move(on_its_way));
  }

  void Deliver(double now) {
    for (size_t i = 0; i < late.size();) {
      if (late[i].due > now) {
        ++i;
        continue;
      }
      const Late arrived = std::move(late[i]);
      late.erase(late.begin() + static_cast<ptrdiff_t>(i));
      if (arrived.comes_in) {
        Take(arrived.bytes, arrived.peer, now);
      } else {
        socket.Send(arrived.bytes, arrived.peer);
      }
    }
  }

  void Take(std::span<const std::byte> bytes, const sockaddr_in& from, double now) {
    if (!internal::Decode(bytes, key, in)) {
      ++dropped;
      return;
    }
    if (in.kind == PacketKind::kHello && !driven) {
      driven = true;
      session = in.session;
      last = in.sequence - 1;
      peer = from;
    }
    const bool is_drivers = driven && in.session == session && internal::IsSame(from, peer);
    if (!is_drivers || !internal::Follows(in.sequence, last)) {
      ++dropped;
      return;
    }
    last = in.sequence;
    if (in.kind == PacketKind::kHello) {
      heard = now;
      Describe(now);
    } else if (in.kind == PacketKind::kCommand || in.kind == PacketKind::kForces) {
      Obey(now);
    } else if (in.kind == PacketKind::kHold) {
      heard = now;
      HoldOnce();
    }
  }

  void Obey(double now) {
    const size_t n = joints.size();
    const bool has_forces = in.kind == PacketKind::kForces;
    const size_t count = (has_forces ? 3 : 2) * n;
    const auto end = in.values.begin() + static_cast<ptrdiff_t>(in.joints == n ? count : 0);
    if (in.joints != n || (has_forces && !arm->takes_forces()) ||
        !std::all_of(in.values.begin(), end, [](double v) { return std::isfinite(v); }) ||
        std::isinf(in.values.back())) {
      ++dropped;
      return;
    }
    heard = now;
    holds = false;
    command.pos.assign(in.values.begin(), in.values.begin() + static_cast<ptrdiff_t>(n));
    const auto forces = in.values.begin() + static_cast<ptrdiff_t>(2 * n);
    command.vel.assign(in.values.begin() + static_cast<ptrdiff_t>(n), forces);
    command.force.assign(forces, end);
    command.opening = in.values.back();
    arm->Send(command);
  }

  void HoldOnce() {
    if (!holds) arm->Hold();
    holds = true;
  }

  void Describe(double now) {
    out.kind = PacketKind::kDescription;
    out.flags = arm->takes_forces() ? internal::kTakesForces : uint16_t{0};
    out.names = joints;
    out.values.clear();
    for (const std::vector<double>* list :
         {&limits.lower, &limits.upper, &limits.velocity, &limits.acceleration, &limits.force})
      out.values.insert(out.values.end(), list->begin(), list->end());
    SendOut(now);
  }

  void SendState(double now) {
    out.kind = PacketKind::kState;
    out.flags = 0;
    out.names.clear();
    out.values.clear();
    for (const std::vector<double>* list : {&measured.pos, &measured.vel, &measured.force})
      out.values.insert(out.values.end(), list->begin(), list->end());
    out.values.push_back(measured.opening);
    SendOut(now);
  }

  void SendOut(double now) {
    out.joints = joints.size();
    out.session = session;
    out.sequence = ++sequence;
    out.time = out.kind == PacketKind::kState ? measured.time : now;
    internal::Encode(out, key, bytes);
    Pass(false, peer, bytes, now);
  }

  std::shared_ptr<ArmPort> arm;
  UdpServerOptions options;
  internal::UdpSocket socket;
  Hash128 key;
  Rng rng;
  std::vector<std::string> joints;
  ArmLimits limits;

  bool driven = false, holds = true;
  uint32_t session = 0, last = 0, sequence = 0;
  sockaddr_in peer{};
  double heard = 0, sent = -std::numeric_limits<double>::infinity();
  int64_t dropped = 0;
  std::vector<Late> late;
  ArmPacket in, out;
  std::vector<std::byte> bytes;
  std::array<std::byte, internal::kMostBytes> room{};
  ArmCommand command;
  ArmMeasurement measured;
};

UdpArmServer::UdpArmServer(std::shared_ptr<ArmPort> arm, const std::string& address,
                           const UdpServerOptions& options) {
  if (!arm) throw ArgumentError("a server needs an arm");
  if (!(options.rate > 0) || !(options.watchdog > 0)) {
    throw ArgumentError(fmt::format("rate is {} and watchdog {}; expected values above 0",
                                    options.rate, options.watchdog));
  }
  impl_ = std::make_unique<Impl>(std::move(arm), address, options);
}

UdpArmServer::~UdpArmServer() = default;

std::string UdpArmServer::address() const { return internal::ToString(impl_->socket.address()); }
bool UdpArmServer::is_driven() const { return impl_->driven; }
int64_t UdpArmServer::dropped() const { return impl_->dropped; }
ArmPort& UdpArmServer::arm() const { return *impl_->arm; }

void UdpArmServer::Poll() {
  Impl& s = *impl_;
  const double now = s.arm->now();
  for (int i = 0; i < kMostAtOnce; ++i) {
    sockaddr_in from{};
    const std::span<const std::byte> got = s.socket.Receive(s.room, from);
    if (got.empty()) break;
    s.Pass(true, from, got, now);
  }
  s.Deliver(now);
  if (s.driven && now - s.heard > s.options.watchdog) {
    s.HoldOnce();
    s.driven = false;
  }
  if (s.arm->Read(s.measured) && s.driven && now - s.sent >= 1 / s.options.rate) {
    s.sent = now;
    s.SendState(now);
    s.Deliver(now);
  }
}

}  // namespace robocell
