#include "robocell/spec/object_place.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/spec/run_config.h"
#include "robocell/spec/testing/messages.h"

namespace robocell {
namespace {

using ::testing::HasSubstr;
using testing::ParseError;
using testing::ValidationError;

TEST(ObjectPlace, RequiresExactlyOneRelation) {
  EXPECT_THAT(ValidationError(ObjectPlace{}),
              HasSubstr("Set one of on_top_of, inside and next_to"));
  EXPECT_THAT(ValidationError(ObjectPlace{.on_top_of = "a", .inside = "b"}),
              HasSubstr("only one of on_top_of, inside and next_to can be set"));
  EXPECT_THAT(ValidationError(ObjectPlace{.next_to = "a", .gap = {0.2, 0.1}}),
              HasSubstr("gap: [0.2, 0.1] is [smallest, largest]; the first is larger"));
  EXPECT_THAT(ValidationError(ObjectPlace{.next_to = "a", .gap = {-0.2, 0.1}}),
              HasSubstr("must not be negative"));
}

TEST(ObjectPlace, ReturnsItsRelationAndReference) {
  const ObjectPlace on{.on_top_of = "a"}, in{.inside = "b"}, by{.next_to = "c"};
  EXPECT_EQ(on.relation(), Relation::kOnTopOf);
  EXPECT_EQ(in.relation(), Relation::kInside);
  EXPECT_EQ(by.relation(), Relation::kNextTo);
  EXPECT_EQ(on.reference() + in.reference() + by.reference(), "abc");
  EXPECT_STREQ(ToString(Relation::kInside), "inside");
}

TEST(ObjectPlace, ReportsErrorsAtItsPlaceInARunFile) {
  EXPECT_THAT(ParseError<RunConfig>("run: r\nrobot: {name: a, model: b}\noutput: o\n"
                                    "start:\n  places:\n    mug: {ontop_of: shelf}\n"),
              AllOf(HasSubstr("f.yaml:6:"), HasSubstr("Did you mean 'on_top_of'?")));
}

}  // namespace
}  // namespace robocell
