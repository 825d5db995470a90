#include "robocell/spec/edit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/spec/testing/messages.h"

namespace robocell {
namespace {

using ::testing::HasSubstr;
using testing::ValidationError;

ElementRef Named(const std::string& name) { return {.name = name}; }

TEST(Edit, LimitsTheFieldOfViewToHalfATurn) {
  EXPECT_THAT(ValidationError(Edit{.camera = Named("a"), .fovy = 180}),
              HasSubstr("fovy: 180 degrees is not below 180"));
}

TEST(Edit, AcceptsValidEdits) {
  EXPECT_EQ(ValidationError(Edit{.body = Named("a"), .pos = Vec3{}}), "");
  EXPECT_EQ(ValidationError(Edit{.body = Named("a"), .add_site = "tool"}), "");
  EXPECT_EQ(ValidationError(Edit{.body = Named("a"), .add_camera = "view", .fovy = 45}), "");
  EXPECT_EQ(ValidationError(Edit{.site = Named("a"), .add_sensor = "ft", .type = "force"}), "");
  EXPECT_EQ(ValidationError(Edit{.geom = ElementRef{.body = "a", .index = 3}, .condim = 4}), "");
  EXPECT_EQ(
      ValidationError(Edit{.remove = ElementRef{.kind = ElementKind::kCamera, .name = "view"}}),
      "");
}

TEST(Edit, NamesExactlyOneElement) {
  EXPECT_THAT(ValidationError(Edit{.pos = Vec3{}}), HasSubstr("this one names none"));
  EXPECT_THAT(ValidationError(Edit{.body = Named("a"), .site = Named("b"), .pos = Vec3{}}),
              HasSubstr("this one names body, site"));
}

TEST(Edit, ListsTheAttributesOfAnElement) {
  EXPECT_EQ(
      ValidationError(Edit{.joint = Named("a"), .fovy = 45}),
      "it is not valid: fovy: a joint has no such attribute; it can be given name, pos, range, "
      "damping, armature, frictionloss");
}

TEST(Edit, RejectsAnEmptyEdit) {
  EXPECT_THAT(ValidationError(Edit{.site = Named("a")}), HasSubstr("changes nothing; it can set"));
}

TEST(Edit, AddingNeedsAPlace) {
  EXPECT_THAT(ValidationError(Edit{.add_camera = "view", .fovy = 45}),
              HasSubstr("says no `body` to add to"));
  EXPECT_THAT(ValidationError(Edit{.add_sensor = "ft"}),
              ::testing::AllOf(HasSubstr("needs the `site`"), HasSubstr("needs a `type`")));
}

TEST(Edit, DeletingNeedsTheKind) {
  EXPECT_THAT(ValidationError(Edit{.remove = Named("view")}),
              HasSubstr("delete: say what kind of element it is"));
  EXPECT_THAT(ValidationError(Edit{.remove = ElementRef{.kind = ElementKind::kSite, .name = "a"},
                                   .pos = Vec3{}}),
              HasSubstr("a deleted element cannot be given pos"));
}

TEST(Edit, OneRotationIsEnough) {
  EXPECT_THAT(ValidationError(Edit{.body = Named("a"), .quat = kIdentityQuat, .euler = Vec3{}}),
              HasSubstr("give only one of quat, euler and xyaxes"));
  EXPECT_THAT(ValidationError(Edit{.body = Named("a"), .quat = Vec4{0, 0, 0, 2}}),
              HasSubstr("quat: [0, 0, 0, 2] has length 2"));
}

TEST(Edit, RequiresIncreasingRangesAndAValidCondim) {
  EXPECT_THAT(ValidationError(Edit{.joint = Named("a"), .range = Vec2{1, -1}}),
              HasSubstr("range: [1, -1] is [smallest, largest]; the first is larger"));
  EXPECT_THAT(ValidationError(Edit{.geom = Named("a"), .condim = 2}),
              HasSubstr("condim: 2 is not 1, 3, 4 or 6"));
}

TEST(Edit, AnUnnamedGeomNeedsItsIndex) {
  EXPECT_THAT(
      ValidationError(Edit{.geom = ElementRef{.kind = ElementKind::kBody, .name = "pad"},
                           .friction = Vec3{1, 0, 0}}),
      HasSubstr("geom: is given a body 'pad'; write the geom's name, or {body: name, index: "
                "0} if it has none"));
}

}  // namespace
}  // namespace robocell
