#include "robocell/base/siphash.h"

#include <cstdio>
#include <string>

#include <gtest/gtest.h>

namespace robocell {
namespace {

std::string Bytes(int count) {
  std::string bytes;
  for (int i = 0; i < count; ++i) bytes.push_back(static_cast<char>(i));
  return bytes;
}

std::string Hex(const Hash128& hash) {
  std::string hex;
  for (int i = 0; i < 16; ++i) {
    char pair[3];
    std::snprintf(pair, sizeof pair, "%02X",
                  static_cast<unsigned>(hash[i / 8] >> (8 * (i % 8)) & 0xff));
    hex += pair;
  }
  return hex;
}

// The output of `openssl mac -macopt hexkey:000102030405060708090a0b0c0d0e0f -macopt size:16 -in
// FILE SIPHASH` for files with the bytes 0, 1, 2, ...
TEST(SipHash, AgreesWithOpenssl) {
  const Hash128 key = {0x0706050403020100, 0x0f0e0d0c0b0a0908};
  EXPECT_EQ(Hex(SipHash128(key, Bytes(0))), "A3817F04BA25A8E66DF67214C7550293");
  EXPECT_EQ(Hex(SipHash128(key, Bytes(1))), "DA87C1D86B99AF44347659119B22FC45");
  EXPECT_EQ(Hex(SipHash128(key, Bytes(7))), "A1F1EBBED8DBC153C0B84AA61FF08239");
  EXPECT_EQ(Hex(SipHash128(key, Bytes(8))), "3B62A9BA6258F5610F83E264F31497B4");
  EXPECT_EQ(Hex(SipHash128(key, Bytes(15))), "5493E99933B0A8117E08EC0F97CFC3D9");
  EXPECT_EQ(Hex(SipHash128(key, Bytes(20))), "9E25FC833F2290733E9344A5E83839EB");
}

}  // namespace
}  // namespace robocell
