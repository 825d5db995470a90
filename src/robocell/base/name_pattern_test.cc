#include "robocell/base/name_pattern.h"

#include <fnmatch.h>
#include <gtest/gtest.h>

#include <string>

#include "robocell/base/rng.h"

namespace robocell::internal {
namespace {

TEST(NamePattern, DecidesLikeFnmatchForRandomNamesAndPatterns) {
  Rng rng = Rng::Stream(1, "patterns");
  const auto draw = [&](const std::string& letters, int most) {
    std::string text;
    for (int i = static_cast<int>(rng.Uniform(0, most + 1)); i > 0; --i)
      text += letters[static_cast<size_t>(rng.Uniform(0, static_cast<double>(letters.size())))];
    return text;
  };
  int fits = 0;
  for (int i = 0; i < 3000; ++i) {
    const std::string pattern = draw("ab/*?", 6), name = draw("ab/", 7);
    const bool expected = ::fnmatch(pattern.c_str(), name.c_str(), FNM_NOESCAPE) == 0;
    EXPECT_EQ(FitsPattern(pattern, name), expected) << pattern << " and " << name;
    fits += expected ? 1 : 0;
  }
  EXPECT_GT(fits, 200);
}

TEST(NamePattern, ManyStarsTakeNoExponentialTime) {
  std::string pattern;
  for (int i = 0; i < 60; ++i) pattern += "*a";
  EXPECT_FALSE(FitsPattern(pattern + "b", std::string(2000, 'a')));
  EXPECT_TRUE(FitsPattern(pattern, std::string(2000, 'a')));
}

TEST(NamePattern, BracketsAreCharactersOfNames) {
  EXPECT_TRUE(FitsPattern("cup[0]", "cup[0]"));
  EXPECT_FALSE(FitsPattern("cup[0]", "cup0"));
  EXPECT_TRUE(IsNamePattern("cup_?"));
  EXPECT_FALSE(IsNamePattern("cup_1"));
}

}  // namespace
}  // namespace robocell::internal
