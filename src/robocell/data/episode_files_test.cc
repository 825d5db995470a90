#include "robocell/data/episode_files.h"

#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

std::string Text() {
  return "{\"id\": \"pick\", \"run\": {\"json_sha256\": \"" + std::string(kUnsigned) + "\"}}\n";
}

TEST(EpisodeJson, EveryBitCounts) {
  const std::string text = SignEpisodeJson(Text());
  EXPECT_EQ(text.size(), Text().size());
  EXPECT_TRUE(EpisodeJsonIsIntact(text));
  for (size_t bit = 0; bit < 8 * text.size(); ++bit) {
    std::string flipped = text;
    flipped[bit / 8] ^= static_cast<char>(1 << bit % 8);
    EXPECT_FALSE(EpisodeJsonIsIntact(flipped)) << "bit " << bit;
  }
  for (size_t size = 0; size < text.size(); ++size) {
    EXPECT_FALSE(EpisodeJsonIsIntact(text.substr(0, size))) << size << " bytes";
  }
  EXPECT_FALSE(EpisodeJsonIsIntact(text + " "));
}

TEST(EpisodeJson, ATextWithoutAPlaceForItsHashIsRefused) {
  ExpectThrow<Error>([] { SignEpisodeJson("{}"); }, "no place for its hash");
  EXPECT_FALSE(EpisodeJsonIsIntact("{}"));
  EXPECT_FALSE(EpisodeJsonIsIntact(Text()));
}

}  // namespace
}  // namespace robocell
