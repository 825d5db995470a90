#include "robocell/hardware/arm_packet.h"

#include <fmt/format.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/hash.h"

namespace robocell::internal {
namespace {

static_assert(std::endian::native == std::endian::little, "packets are little-endian");

constexpr char kMagic[4] = {'R', 'B', 'A', '1'};
constexpr size_t kHead = 24, kChecksum = sizeof(Hash128);
constexpr Hash128 kKeyOfSecrets = {0x726f626f63656c6c, 0x61726d7061636b31};

// Returns how many values a packet has; unset sizes are those of an unknown kind.
constexpr size_t kUnknown = ~size_t{0};
size_t ValuesOf(PacketKind kind, size_t joints) {
  switch (kind) {
    case PacketKind::kHello:
    case PacketKind::kHold:
      return 0;
    case PacketKind::kDescription:
      return 5 * joints;
    case PacketKind::kState:
      return 3 * joints + 1;
    case PacketKind::kCommand:
      return 2 * joints + 1;
    case PacketKind::kForces:
      return 3 * joints + 1;
  }
  return kUnknown;
}

template <class T>
void Put(const T& value, std::vector<std::byte>& out) {
  static_assert(std::is_trivially_copyable_v<T>);
  const auto* bytes = reinterpret_cast<const std::byte*>(&value);
  out.insert(out.end(), bytes, bytes + sizeof value);
}

// Reads from the front of the bytes. Returns false if there are too few.
template <class T>
bool Take(std::span<const std::byte>& bytes, T& value) {
  if (bytes.size() < sizeof value) return false;
  std::memcpy(&value, bytes.data(), sizeof value);
  bytes = bytes.subspan(sizeof value);
  return true;
}

Hash128 Checksum(std::span<const std::byte> bytes, const Hash128& key) {
  return SipHash128(key, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

bool TakeNames(std::span<const std::byte>& bytes, size_t count, std::vector<std::string>& names) {
  names.resize(count);
  for (std::string& name : names) {
    uint16_t size = 0;
    if (!Take(bytes, size) || bytes.size() < size) return false;
    name.assign(reinterpret_cast<const char*>(bytes.data()), size);
    bytes = bytes.subspan(size);
  }
  return true;
}

}  // namespace

Hash128 PacketKey(std::string_view secret) { return SipHash128(kKeyOfSecrets, secret); }

void Encode(const ArmPacket& packet, const Hash128& key, std::vector<std::byte>& out) {
  if (packet.joints > kMostJoints) {
    throw ArgumentError(
        fmt::format("an arm of {} joints; a packet has room for {}", packet.joints, kMostJoints));
  }
  if (packet.values.size() != ValuesOf(packet.kind, packet.joints)) {
    throw ArgumentError(fmt::format("a packet of kind {} for {} joints with {} values",
                                    static_cast<int>(packet.kind), packet.joints,
                                    packet.values.size()));
  }
  out.clear();
  for (const char c : kMagic) Put(c, out);
  Put(packet.kind, out);
  Put(static_cast<uint8_t>(packet.joints), out);
  Put(packet.flags, out);
  Put(packet.session, out);
  Put(packet.sequence, out);
  Put(packet.time, out);
  for (const double value : packet.values) Put(value, out);
  if (packet.kind == PacketKind::kDescription) {
    for (const std::string& name : packet.names) {
      Put(static_cast<uint16_t>(name.size()), out);
      for (const char c : name) Put(c, out);
    }
  }
  if (out.size() + kChecksum > kMostBytes) {
    throw ArgumentError(
        fmt::format("the names of {} joints take more than {} bytes", packet.joints, kMostBytes));
  }
  Put(Checksum(out, key), out);
}

bool Decode(std::span<const std::byte> bytes, const Hash128& key, ArmPacket& out) {
  if (bytes.size() < kHead + kChecksum || bytes.size() > kMostBytes) return false;
  if (std::memcmp(bytes.data(), kMagic, sizeof kMagic) != 0) return false;
  std::span<const std::byte> rest = bytes.subspan(bytes.size() - kChecksum);
  Hash128 checksum{};
  if (!Take(rest, checksum) || checksum != Checksum(bytes.first(bytes.size() - kChecksum), key))
    return false;
  rest = bytes.subspan(sizeof kMagic, bytes.size() - kChecksum - sizeof kMagic);
  uint8_t joints = 0;
  if (!Take(rest, out.kind) || !Take(rest, joints) || !Take(rest, out.flags)) return false;
  if (!Take(rest, out.session) || !Take(rest, out.sequence) || !Take(rest, out.time)) return false;
  out.joints = joints;
  const size_t count = ValuesOf(out.kind, joints);
  if (joints > kMostJoints || count == kUnknown) return false;
  out.values.resize(count);
  for (double& value : out.values) {
    if (!Take(rest, value)) return false;
  }
  out.names.clear();
  if (out.kind == PacketKind::kDescription && !TakeNames(rest, joints, out.names)) return false;
  return rest.empty();
}

}  // namespace robocell::internal
