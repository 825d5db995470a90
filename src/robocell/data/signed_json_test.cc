#include "robocell/data/signed_json.h"

#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

std::string Text() {
  return "{\"id\": \"pick\", \"run\": {\"json_sha256\": \"" + std::string(kUnsigned) + "\"}}\n";
}

TEST(SignedJson, EveryBitCounts) {
  const std::string text = SignJson(Text());
  EXPECT_EQ(text.size(), Text().size());
  EXPECT_TRUE(JsonIsIntact(text));
  for (size_t bit = 0; bit < 8 * text.size(); ++bit) {
    std::string flipped = text;
    flipped[bit / 8] ^= static_cast<char>(1 << bit % 8);
    EXPECT_FALSE(JsonIsIntact(flipped)) << "bit " << bit;
  }
  for (size_t size = 0; size < text.size(); ++size) {
    EXPECT_FALSE(JsonIsIntact(text.substr(0, size))) << size << " bytes";
  }
  EXPECT_FALSE(JsonIsIntact(text + " "));
}

TEST(SignedJson, ATextWithoutAPlaceForItsHashIsRefused) {
  ExpectThrow<Error>([] { SignJson("{}"); }, "no place for its hash");
  EXPECT_FALSE(JsonIsIntact("{}"));
  EXPECT_FALSE(JsonIsIntact(Text()));
}

}  // namespace
}  // namespace robocell
