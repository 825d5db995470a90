#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "robocell/base/checked_json.h"
#include "robocell/base/error.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::HasSubstr;
using ::testing::Optional;

std::string Text() {
  return "{\"id\": \"pick\", \"run\": {\"json_sha256\": \"" + std::string(kHashPlaceholder) +
         "\"}}\n";
}

TEST(SelfHashedJson, DetectsEveryFlippedBit) {
  const std::string text = InsertSelfHash(Text());
  EXPECT_EQ(text.size(), Text().size());
  EXPECT_EQ(JsonDamage(text), std::nullopt);
  for (size_t bit = 0; bit < 8 * text.size(); ++bit) {
    std::string flipped = text;
    flipped[bit / 8] ^= static_cast<char>(1 << bit % 8);
    EXPECT_TRUE(JsonDamage(flipped)) << "bit " << bit;
  }
  for (size_t size = 0; size < text.size(); ++size) {
    EXPECT_TRUE(JsonDamage(text.substr(0, size))) << size << " bytes";
  }
  EXPECT_THAT(JsonDamage(text + " "), Optional(HasSubstr("its hash does not match its text")));
}

TEST(SelfHashedJson, RejectsATextWithoutAHashPlaceholder) {
  ExpectThrow<Error>([] { InsertSelfHash("{}"); }, "no placeholder for its own hash");
  EXPECT_THAT(JsonDamage("{\"id\": \"a"),
              ::testing::Optional(
                  std::string("it is cut short: its text ends after 9 bytes, in the middle")));
  EXPECT_THAT(JsonDamage("{}"), Optional(HasSubstr("carries no hash of itself")));
  EXPECT_THAT(JsonDamage(Text()), Optional(HasSubstr("its hash does not match its text")));
}

using Json = nlohmann::ordered_json;

TEST(JsonCount, AcceptsOnlyIntegersInItsRange) {
  EXPECT_EQ(JsonCount<int>(Json::parse("0")), 0);
  EXPECT_EQ(JsonCount<int>(Json::parse("2147483647")), 2147483647);
  EXPECT_EQ(JsonCount<uint64_t>(Json::parse("18446744073709551615")), ~uint64_t{0});
  for (const char* text : {"2147483648", "-1", "1.0", "5.3e81", "\"1\"", "null", "[1]"})
    EXPECT_THROW(JsonCount<int>(Json::parse(text)), nlohmann::json::exception) << text;
}

}  // namespace
}  // namespace robocell
