#include "robocell/hardware/udp_arm.h"

#include <netinet/in.h>
#include <fmt/format.h>

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/hash.h"
#include "robocell/hardware/arm_packet.h"
#include "robocell/hardware/arm_port.h"
#include "robocell/hardware/udp_socket.h"

namespace robocell {
namespace {

using internal::ArmPacket;
using internal::PacketKind;

constexpr std::chrono::milliseconds kBetweenHellos{50};
constexpr double kSilence = 0.05;  // s, after which Read greets the arm again
constexpr int kMostPackets = 64;   // of one Read: a flood must not hold the loop

sockaddr_in CheckedAddress(const std::string& address, bool remote) {
  const sockaddr_in parsed = internal::ParseAddress(address);
  if (remote || internal::IsLoopback(parsed)) return parsed;
  throw ArgumentError(fmt::format("{} is another computer; pass remote=true if the arm is there",
                                  internal::ToString(parsed)));
}

// A socket of its own computer sends to its own computer only.
sockaddr_in OwnAddress(bool remote) {
  return internal::ParseAddress(remote ? "0.0.0.0:0" : "127.0.0.1:0");
}

uint32_t NewSession(const internal::UdpSocket& socket) {
  const auto ticks = std::chrono::steady_clock::now().time_since_epoch().count();
  return static_cast<uint32_t>(static_cast<uint64_t>(ticks) * 2654435761U) ^
         socket.address().sin_port;
}

}  // namespace

struct UdpArm::Impl {
  Impl(const std::string& text, const UdpArmOptions& options)
      : address(CheckedAddress(text, options.remote)),
        socket(OwnAddress(options.remote)),
        key(internal::PacketKey(options.secret)),
        session(NewSession(socket)) {}

  void Send(PacketKind kind, size_t joints) {
    out.kind = kind;
    out.session = session;
    out.sequence = ++sequence;
    out.joints = joints;
    internal::Encode(out, key, bytes);
    socket.Send(bytes, address);
  }
  // Takes the next packet of the arm. Returns false if there is none.
  bool Receive() {
    for (int i = 0; i < kMostPackets; ++i) {
      sockaddr_in from{};
      const std::span<const std::byte> got = socket.Receive(room, from);
      if (got.empty()) return false;
      const bool good = internal::IsSame(from, address) && internal::Decode(got, key, in) &&
                        in.session == session && (!heard || internal::Follows(in.sequence, last));
      if (good) {
        last = in.sequence;
        heard = true;
        return true;
      }
      ++dropped;
    }
    return false;
  }

  sockaddr_in address;
  internal::UdpSocket socket;
  Hash128 key;
  uint32_t session, sequence = 0, last = 0;
  bool heard = false;
  double spoken = 0;  // when the arm sent its state, or was greeted
  int64_t dropped = 0;
  bool takes_forces = false;
  ArmPacket in, out;
  std::vector<std::byte> bytes;
  std::array<std::byte, internal::kMostBytes> room{};
  std::vector<std::string> joints;
  ArmLimits limits;
};

UdpArm::UdpArm(const std::string& address, const UdpArmOptions& options)
    : impl_(std::make_unique<Impl>(address, options)) {
  Impl& s = *impl_;
  const double end = now() + options.timeout;
  while (s.joints.empty()) {
    s.out.values.clear();
    s.Send(PacketKind::kHello, 0);
    std::this_thread::sleep_for(kBetweenHellos / 10);
    while (s.joints.empty() && s.Receive()) {
      if (s.in.kind != PacketKind::kDescription || s.in.joints == 0) continue;
      const size_t n = s.in.joints;
      std::vector<double>* const lists[] = {&s.limits.lower, &s.limits.upper, &s.limits.velocity,
                                            &s.limits.acceleration, &s.limits.force};
      auto from = s.in.values.begin();
      for (std::vector<double>* list : lists) {
        list->assign(from, from + static_cast<ptrdiff_t>(n));
        from += static_cast<ptrdiff_t>(n);
      }
      RequireValid(s.limits, s.in.names, name());
      s.joints = s.in.names;
      s.takes_forces = (s.in.flags & internal::kTakesForces) != 0;
    }
    if (!s.joints.empty()) break;
    if (!(now() < end)) {
      throw IoError(fmt::format("no arm answers at {} within {} s{}", name(), options.timeout,
                                s.dropped == 0
                                    ? ". Its server does not run, has another secret, or another "
                                      "program drives the arm"
                                    : "; what arrives is damaged or has another secret"));
    }
    std::this_thread::sleep_for(kBetweenHellos);
  }
}

UdpArm::~UdpArm() = default;

std::string UdpArm::name() const { return "udp " + internal::ToString(impl_->address); }
std::vector<std::string> UdpArm::joint_names() const { return impl_->joints; }
ArmLimits UdpArm::limits() const { return impl_->limits; }
bool UdpArm::takes_forces() const { return impl_->takes_forces; }
int64_t UdpArm::dropped() const { return impl_->dropped; }

bool UdpArm::Read(ArmMeasurement& out) {
  Impl& s = *impl_;
  const size_t n = s.joints.size();
  bool found = false;
  while (s.Receive()) {
    if (s.in.kind != PacketKind::kState || s.in.joints != n) continue;
    const std::span<const double> values(s.in.values);
    out.time = s.in.time;
    out.pos.assign(values.begin(), values.begin() + static_cast<ptrdiff_t>(n));
    const std::span<const double> vel = values.subspan(n, n), force = values.subspan(2 * n, n);
    out.vel.assign(vel.begin(), vel.end());
    out.force.assign(force.begin(), force.end());
    out.opening = values.back();
    found = true;
  }
  const double at = now();
  if (found) {
    s.spoken = at;
  } else if (at - s.spoken > kSilence) {
    s.spoken = s.out.time = at;
    s.out.values.clear();
    s.Send(PacketKind::kHello, 0);
  }
  return found;
}

void UdpArm::Send(const ArmCommand& command) {
  ArmPacket& out = impl_->out;
  out.time = now();
  out.values.assign(command.pos.begin(), command.pos.end());
  out.values.insert(out.values.end(), command.vel.begin(), command.vel.end());
  out.values.insert(out.values.end(), command.force.begin(), command.force.end());
  out.values.push_back(command.opening);
  const PacketKind kind = command.force.empty() ? PacketKind::kCommand : PacketKind::kForces;
  impl_->Send(kind, impl_->joints.size());
}

void UdpArm::Hold() {
  impl_->out.time = now();
  impl_->out.values.clear();
  for (int i = 0; i < 3; ++i)
    impl_->Send(PacketKind::kHold, impl_->joints.size());  // one may be lost
}

}  // namespace robocell
