#include "robocell/base/siphash.h"

#include <bit>
#include <cstddef>

namespace robocell {
namespace {

struct SipState {
  uint64_t v0, v1, v2, v3;

  void Round() {
    v0 += v1, v1 = std::rotl(v1, 13) ^ v0, v0 = std::rotl(v0, 32);
    v2 += v3, v3 = std::rotl(v3, 16) ^ v2;
    v0 += v3, v3 = std::rotl(v3, 21) ^ v0;
    v2 += v1, v1 = std::rotl(v1, 17) ^ v2, v2 = std::rotl(v2, 32);
  }
  void Absorb(uint64_t word) {
    v3 ^= word;
    Round(), Round();
    v0 ^= word;
  }
  uint64_t Squeeze() {
    Round(), Round(), Round(), Round();
    return v0 ^ v1 ^ v2 ^ v3;
  }
};

uint64_t LittleEndian(std::string_view bytes) {
  uint64_t word = 0;
  for (size_t i = 0; i < bytes.size(); ++i) {
    word |= static_cast<uint64_t>(static_cast<unsigned char>(bytes[i])) << (8 * i);
  }
  return word;
}

}  // namespace

Hash128 SipHash128(const Hash128& key, std::string_view bytes) {
  SipState s{0x736f6d6570736575 ^ key[0], 0x646f72616e646f6d ^ key[1] ^ 0xee,
             0x6c7967656e657261 ^ key[0], 0x7465646279746573 ^ key[1]};
  const uint64_t size = bytes.size();
  for (; bytes.size() >= 8; bytes.remove_prefix(8)) s.Absorb(LittleEndian(bytes.substr(0, 8)));
  s.Absorb(LittleEndian(bytes) | size << 56);
  s.v2 ^= 0xee;
  const uint64_t low = s.Squeeze();
  s.v1 ^= 0xdd;
  return {low, s.Squeeze()};
}

}  // namespace robocell
