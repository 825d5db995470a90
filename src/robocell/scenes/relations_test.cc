// Tests the sentences of relations; what they mean is in built_in_relations_test.cc.
#include "robocell/scenes/relations.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "robocell/base/error.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(ParseRelation, FillsInDefaultsAndWritesItselfAgain) {
  const StatedRelation beside = ParseRelation("  mug  next_to box ");
  EXPECT_EQ(beside.subject, "mug");
  EXPECT_EQ(beside.relation, "next_to");
  EXPECT_EQ(beside.reference, "box");
  EXPECT_THAT(beside.numbers, ElementsAre(0.05));
  EXPECT_EQ(TextOf(beside), "mug next_to box 0.05");
  EXPECT_EQ(TextOf(ParseRelation("drawer open >= 0.5")), "drawer open 0.5");
  EXPECT_EQ(TextOf(ParseRelation("cup in_region 0.4 -0.1 0.05")), "cup in_region 0.4 -0.1 0.05");
  EXPECT_EQ(TextOf(ParseRelation("cup in_region mark")), "cup in_region mark");
  EXPECT_EQ(WordsOf(beside, "mug", "red box"), "put the mug next to the red box");
}

TEST(ParseRelation, RejectsWhatIsNoRelation) {
  const auto why = [](const std::string& text) {
    return ExpectThrow<ArgumentError>([&] { ParseRelation(text); }, "");
  };
  EXPECT_THAT(why("mug"), HasSubstr("write SUBJECT RELATION"));
  EXPECT_THAT(why("mug insde tray"), HasSubstr("Did you mean 'inside'?"));
  EXPECT_THAT(why("mug inside"), HasSubstr("lacks the name of what it relates to"));
  EXPECT_THAT(why("mug inside tray 0.3"), HasSubstr("has 1 number too many"));
  EXPECT_THAT(why("mug next_to box -0.1"), HasSubstr("at least 0"));
  EXPECT_THAT(why("mug next_to box nut"), HasSubstr("has the word 'nut' too many"));
  EXPECT_THAT(why("mug next_to mug"), HasSubstr("relates an object to itself"));
  EXPECT_THAT(why("mug upright tray"), HasSubstr("does not take"));
  EXPECT_THAT(why("drawer open 5"), HasSubstr("go from 0 to 1"));
  EXPECT_THAT(why("cup in_region 1 2"), HasSubstr("has 2 numbers, not 3"));
  EXPECT_THAT(why("cup in_region 1 2 0"), HasSubstr("must be above 0"));
}

}  // namespace
}  // namespace robocell
