// Tests the sentences of relations; what they mean is in built_in_relations_test.cc.
#include "robocell/scenes/relations.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
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
  EXPECT_EQ(TextOf(ParseRelation("drawer closed <= 0.2")), "drawer closed 0.2");
  EXPECT_EQ(TextOf(ParseRelation("mug next_to box <= 0.1")), "mug next_to box 0.1");
  EXPECT_EQ(TextOf(ParseRelation("mug upright <= 0.1")), "mug upright 0.1");
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
  for (const char* share : {"5", "0", "1.01"})
    EXPECT_THAT(why(std::string("peg inserted hole ") + share), HasSubstr("above 0 and at most 1"));
  EXPECT_THAT(why("cup in_region 1 2"), HasSubstr("has 2 numbers, not 3"));
  EXPECT_THAT(why("cup in_region 1 2 0"), HasSubstr("must be above 0"));
}

// A comparison that is not the relation's own would state the opposite goal.
TEST(ParseRelation, TakesTheComparisonOfItsRelationOnly) {
  const auto why = [](const std::string& text) {
    return ExpectThrow<ArgumentError>([&] { ParseRelation(text); }, "");
  };
  for (const std::string& name : RelationNames()) {
    const RelationKind kind = FindRelation(name);
    for (const std::string comparison : {">=", "<="}) {
      const bool has_reference = kind.reference != RelationReference::kNone;
      const std::string text = "a " + name + (has_reference ? " b " : " ") + comparison;
      EXPECT_THAT(why(text), HasSubstr("write: A " + name)) << text;
      if (kind.defaults.empty()) continue;
      if (comparison == kind.comparison) {
        EXPECT_EQ(ParseRelation(text + " 0.4").numbers.front(), 0.4);
      } else {
        EXPECT_THAT(why(text + " 0.4"), HasSubstr("takes '" + kind.comparison + "' only"));
      }
    }
  }
  EXPECT_THAT(why("mug on tray <="), HasSubstr("takes no comparison"));
  EXPECT_THAT(why("drawer open 0.3 >="), HasSubstr("without a number after it"));
  EXPECT_THAT(why("drawer open >= >= 0.3"), HasSubstr("without a number after it"));
}

TEST(ParseRelation, TakesNamesInQuotes) {
  for (const std::string name : {"left door", "0.5", ">=", "cook's door", "the \"red\" one"}) {
    const StatedRelation stated{
        .subject = name, .relation = "next_to", .reference = "big box", .numbers = {0.1}};
    const StatedRelation again = ParseRelation(TextOf(stated));
    EXPECT_EQ(again.subject, name);
    EXPECT_EQ(again.reference, "big box");
    EXPECT_EQ(again.numbers, stated.numbers);
  }
  ExpectThrow<ArgumentError>([&] { ParseRelation("'left door open"); }, "lacks the quote");
}

TEST(RegisterRelation, RejectsWordsThatAreNoInstruction) {
  const auto bind = [](const Scene&, const StatedRelation&) {
    return std::unique_ptr<BoundRelation>();
  };
  for (const char* words : {"put the {0", "put {2} there", "put {:d} there", "a } b"})
    ExpectThrow<ArgumentError>([&] { RegisterRelation("near", {.words = words, .bind = bind}); },
                               "are no instruction");
  EXPECT_THAT(RelationNames(), ::testing::Not(::testing::Contains("near")));
}

}  // namespace
}  // namespace robocell
