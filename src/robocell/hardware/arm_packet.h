// ArmPacket: what a computer and an arm say to each other by datagrams: one packet is one datagram.
// It carries a sequence number, which tells repeated and late packets, the session that it belongs
// to, and a keyed checksum (SipHash-2-4-128), which tells damaged and, with a secret, foreign ones.
//
//   byte  0  "RBA1"
//         4  kind, joints, flags (16 bits): 1 in a description of an arm that takes forces
//         8  session, sequence: 32-bit whole numbers
//        16  time: s of the sender's clock
//        24  values: 64-bit floating-point numbers, as many as the kind has
//            names (a description only): each a 16-bit size and its text
//            checksum: 16 bytes
//
// All numbers are little-endian. Private to hardware/.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "robocell/base/hash.h"

namespace robocell::internal {

enum class PacketKind : uint8_t {
  kHello = 1,    // of a computer: describe yourself
  kDescription,  // of an arm: limits (lower, upper, velocity, acceleration, force) and names
  kState,        // of an arm: positions, velocities, forces, opening
  kCommand,      // of a computer: positions, velocities, opening
  kHold,         // of a computer: hold where you are
  kForces,       // of a computer: positions, velocities, forces, opening
};

inline constexpr uint16_t kTakesForces = 1;

struct ArmPacket {
  PacketKind kind = PacketKind::kHello;
  uint16_t flags = 0;
  uint32_t session = 0, sequence = 0;
  double time = 0;
  size_t joints = 0;
  std::vector<double> values = {};
  std::vector<std::string> names = {};
};

inline constexpr size_t kMostJoints = 64;
inline constexpr size_t kMostBytes = 8192;

// Returns the key of a secret, which both sides have; "" is the key of those without one.
Hash128 PacketKey(std::string_view secret);
// Writes the packet. Throws ArgumentError for one with more joints or longer names than fit.
void Encode(const ArmPacket& packet, const Hash128& key, std::vector<std::byte>& out);
// Returns false for bytes that are no whole packet with this key; `out` is then unspecified.
bool Decode(std::span<const std::byte> bytes, const Hash128& key, ArmPacket& out);

// Returns true if `next` follows `last`, also after the numbers have begun again at zero.
inline bool Follows(uint32_t next, uint32_t last) { return static_cast<int32_t>(next - last) > 0; }

}  // namespace robocell::internal
