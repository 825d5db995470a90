#include "robocell/hardware/arm_packet.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/rng.h"

namespace robocell::internal {
namespace {

ArmPacket Description() {
  return {.kind = PacketKind::kDescription,
          .session = 9,
          .sequence = 4,
          .time = 1.5,
          .joints = 2,
          .values = std::vector<double>(10, 0.25),
          .names = {"shoulder", "élan"}};
}

TEST(ArmPacket, ComesBackAsItWas) {
  const Hash128 key = PacketKey("");
  std::vector<std::byte> bytes;
  for (const ArmPacket& packet :
       {Description(), ArmPacket{.kind = PacketKind::kState, .joints = 1, .values = {1, 2, 3, NAN}},
        ArmPacket{.kind = PacketKind::kCommand, .joints = 1, .values = {1, 2, 0.5}}, ArmPacket{}}) {
    Encode(packet, key, bytes);
    ArmPacket back;
    ASSERT_TRUE(Decode(bytes, key, back));
    EXPECT_EQ(back.kind, packet.kind);
    EXPECT_EQ(back.session, packet.session);
    EXPECT_EQ(back.sequence, packet.sequence);
    EXPECT_EQ(back.time, packet.time);
    EXPECT_EQ(back.names, packet.names);
    ASSERT_EQ(back.values.size(), packet.values.size());
  }
}

TEST(ArmPacket, IsRejectedWithAnyByteChangedLostOrAdded) {
  const Hash128 key = PacketKey("secret");
  std::vector<std::byte> bytes;
  Encode(Description(), key, bytes);
  ArmPacket out;
  EXPECT_FALSE(Decode(bytes, PacketKey("guess"), out));
  for (size_t i = 0; i < bytes.size(); ++i) {
    std::vector<std::byte> changed = bytes;
    changed[i] ^= std::byte{1};
    EXPECT_FALSE(Decode(changed, key, out)) << i;
    EXPECT_FALSE(Decode(std::span(bytes).first(i), key, out)) << i;
  }
  bytes.push_back(std::byte{0});
  EXPECT_FALSE(Decode(bytes, key, out));
}

// Whoever knows the key can still send nonsense.
TEST(ArmPacket, WithAGoodChecksumButNonsenseIsRejected) {
  const Hash128 key = PacketKey("");
  Rng rng = Rng::Stream(3, "packets");
  std::vector<std::byte> bytes;
  ArmPacket out;
  for (int run = 0; run < 300; ++run) {
    Encode(Description(), key, bytes);
    bytes.resize(bytes.size() - sizeof(Hash128));
    const auto at = static_cast<size_t>(rng.Uniform(4, 8));
    bytes[at] = static_cast<std::byte>(rng.Uniform(0, 256));
    bytes.resize(static_cast<size_t>(rng.Uniform(8, static_cast<double>(bytes.size()))));
    const Hash128 sum =
        SipHash128(key, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    const auto* end = reinterpret_cast<const std::byte*>(sum.data());
    bytes.insert(bytes.end(), end, end + sizeof sum);
    EXPECT_FALSE(Decode(bytes, key, out) && out.kind == PacketKind::kDescription);
  }
}

TEST(ArmPacket, RefusesWhatDoesNotFit) {
  std::vector<std::byte> bytes;
  ArmPacket packet = Description();
  packet.values.pop_back();
  EXPECT_THROW(Encode(packet, {}, bytes), ArgumentError);
  packet = {.kind = PacketKind::kHello, .joints = kMostJoints + 1};
  EXPECT_THROW(Encode(packet, {}, bytes), ArgumentError);
  packet = Description();
  packet.names[0] = std::string(kMostBytes, 'x');
  EXPECT_THROW(Encode(packet, {}, bytes), ArgumentError);
}

TEST(ArmPacket, SequenceNumbersBeginAgainAfterTheLast) {
  EXPECT_TRUE(Follows(5, 4));
  EXPECT_FALSE(Follows(4, 4));
  EXPECT_FALSE(Follows(3, 4));
  EXPECT_TRUE(Follows(0, 0xffffffff));
  EXPECT_FALSE(Follows(0xffffffff, 0));
}

}  // namespace
}  // namespace robocell::internal
