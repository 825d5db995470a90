#include "robocell/spec/object_info.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/spec/testing/messages.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::ParseError;

TEST(ObjectInfo, ReadsWordsSizeAndGrasps) {
  const auto info = ParseYaml<ObjectInfo>(
      "category: fruit\ncolour: red\nsynonyms: [red apple]\nsize: [0.07, 0.07, 0.08]\n"
      "grasps: [top, side]\n");
  EXPECT_EQ(info.category, "fruit");
  EXPECT_THAT(info.synonyms.names, ElementsAre("red apple"));
  EXPECT_EQ(info.size, (Vec3{0.07, 0.07, 0.08}));
  EXPECT_THAT(info.grasps, ElementsAre(ObjectGrasp::kTop, ObjectGrasp::kSide));
  EXPECT_FALSE(info.drawn_by_default);
}

TEST(ObjectInfo, ReportsProblemsAtTheirPlace) {
  EXPECT_THAT(ParseError<ObjectInfo>("category: fruit\ncolor: red\n"),
              HasSubstr("f.yaml:2:1: color: an ObjectInfo: no field 'color'. Its fields: "
                        "category, colour, material, synonyms, size, grasps, drawn_by_default. "
                        "Did you mean 'colour'?"));
  EXPECT_THAT(ParseError<ObjectInfo>("grasps: [tip]\n"),
              HasSubstr("f.yaml:1:10: grasps[0]: 'tip' is not one of top, side, rim, handle"));
  EXPECT_THAT(ParseError<ObjectInfo>("category: my fruit\n"),
              HasSubstr("f.yaml:1:11: category: 'my fruit' is no single word"));
  EXPECT_THAT(ParseError<ObjectInfo>("size: [0.1, 0, 0.1]\n"),
              HasSubstr("f.yaml:1:13: size[1]: 0 must be greater than 0"));
}

}  // namespace
}  // namespace robocell
