#include "robocell/spec/scene_object.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/spec/testing/messages.h"
#include "robocell/spec/testing/specs.h"

namespace robocell {
namespace {

using ::testing::HasSubstr;
using testing::ParseError;
using testing::ValidationError;

TEST(SceneObject, APrimitiveRequiresAllItsNumbers) {
  EXPECT_EQ(ValidationError(SceneObject{.name = "cube", .shape = Shape::kBox}),
            "it is not valid, 4 problems:\n"
            "  size: a primitive needs its half sizes, for example [0.02, 0.02, 0.02]\n"
            "  rgba: a primitive needs a colour, for example [1, 0.5, 0, 1]\n"
            "  mass: a primitive needs its mass in kg\n"
            "  friction: a primitive needs its friction, for example [0.8, 0.02, 0.001]");
}

TEST(SceneObject, EachShapeRequiresItsSizes) {
  SceneObject object = Cube("a");
  object.size = Vec3{.02, 0, 0};
  EXPECT_THAT(ValidationError(object), HasSubstr("size: a box needs 3 sizes above 0"));
  object.shape = Shape::kCylinder;
  EXPECT_THAT(ValidationError(object), HasSubstr("size: a cylinder needs 2 sizes above 0"));
  object.shape = Shape::kSphere;
  EXPECT_EQ(ValidationError(object), "");
}

TEST(SceneObject, IsEitherAModelOrAPrimitive) {
  EXPECT_THAT(ValidationError(SceneObject{.name = "a"}), HasSubstr("needs a shape (box, sphere, "
                                                                   "cylinder) or an mjcf_path"));
  SceneObject both = Cube("a");
  both.mjcf_path = "a.xml";
  EXPECT_THAT(ValidationError(both), HasSubstr("has both a shape and an mjcf_path"));
  EXPECT_THAT(ValidationError(SceneObject{.name = "a", .mjcf_path = "a.xml", .mass = 1}),
              HasSubstr("describe a primitive; a model file has its own"));
}

TEST(SceneObject, RejectsInvalidEnumValues) {
  SceneObject object = Cube("a");
  object.shape = static_cast<Shape>(77);
  EXPECT_THAT(ValidationError(object),
              HasSubstr("shape: there is no value 77; expected one of box, sphere, cylinder"));
  object = Cube("a");
  object.attach_to = {static_cast<AttachKind>(55), "x"};
  EXPECT_THAT(ValidationError(object),
              HasSubstr("attach_to: there is no value 55; expected one of world, root"));
}

TEST(SceneObject, ElementNamesRequireNoScene) {
  EXPECT_EQ(SceneObjectElementName("table", "table_top"), "table_table_top");
}

}  // namespace
}  // namespace robocell
