#include "robocell/base/hash.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <string>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

constexpr char kEmpty[] = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";
constexpr char kAbc[] = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
constexpr char kMillionA[] = "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0";

// The examples of FIPS 180-2, appendix B.
TEST(Sha256, AgreesWithTheStandard) {
  EXPECT_EQ(Sha256(""), kEmpty);
  EXPECT_EQ(Sha256("abc"), kAbc);
  EXPECT_EQ(Sha256(std::string(1000000, 'a')), kMillionA);
}

TEST(Sha256, OfAFileIsThatOfItsBytes) {
  const TempDir temp;
  AtomicWrite(temp.path() / "large", std::string(1000000, 'a'));
  AtomicWrite(temp.path() / "empty", "");
  EXPECT_EQ(Sha256File(temp.path() / "large"), kMillionA);
  EXPECT_EQ(Sha256File(temp.path() / "empty"), kEmpty);
}

TEST(Sha256, OfAnUnreadableFileNamesIt) {
  const TempDir temp;
  ExpectThrow<IoError>([&] { Sha256File(temp.path() / "gone"); },
                       "gone': No such file or directory");
  ExpectThrow<IoError>([&] { Sha256File(temp.path()); }, "Is a directory");
}

TEST(Sha256, ChunksMatchTheWhole) {
  Sha256Stream stream;
  stream.Update("a");
  stream.Update("");
  Sha256Stream moved = std::move(stream);
  moved.Update("bc");
  EXPECT_EQ(moved.Hex(), kAbc);
  EXPECT_EQ(moved.Hex(), kAbc);
  moved.Update("d");
  EXPECT_EQ(moved.Hex(), Sha256("abcd"));
}

}  // namespace

namespace {

// The output of `xxhsum -H2`.
TEST(Fingerprint, MatchesReferenceValues) {
  EXPECT_EQ(Fingerprint(""), "99aa06d3014798d86001c324468d497f");
  EXPECT_EQ(Fingerprint("abc"), "06b05ab6733a618578af5f94892f3950");
}

TEST(Fingerprint, OfAFileIsThatOfItsBytesForAnySize) {
  const TempDir temp;
  for (const size_t size : {0, 1, 262144, 262145, 3000000}) {
    std::string bytes(size, 'a');
    for (size_t i = 0; i < size; i += 7) bytes[i] = static_cast<char>(i);
    AtomicWrite(temp / "file", bytes);
    EXPECT_EQ(FingerprintFile(temp / "file"), Fingerprint(bytes)) << size;
  }
}

TEST(Fingerprint, OfAnUnreadableFileNamesIt) {
  const TempDir temp;
  ExpectThrow<IoError>([&] { FingerprintFile(temp / "gone"); }, "gone': No such file or directory");
  ExpectThrow<IoError>([&] { FingerprintFile(temp.path()); }, "Is a directory");
}

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

// What `openssl mac -macopt hexkey:000102030405060708090a0b0c0d0e0f -macopt size:16 -in FILE
// SIPHASH` prints for files with the bytes 0, 1, 2, ...
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
