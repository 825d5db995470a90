#include "robocell/scenes/scene_annotations.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "robocell/testing/pick_scene.h"

namespace robocell {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

SceneSpec WithModel(const std::string& model, const Vec3& pos = {}) {
  SceneSpec spec{.name = "annotated", .base = "tabletop", .add_floor = true};
  SceneObject object{.name = model, .mjcf_path = model};
  object.pos = pos;
  object.fixed = true;
  spec.objects.push_back(object);
  return spec;
}

SceneObject Primitive(const char* name, Shape shape, const Vec3& size) {
  return {.name = name,
          .shape = shape,
          .size = size,
          .rgba = Vec4{1, 0, 0, 1},
          .mass = 1,
          .friction = Vec3{1, 0.02, 0.001}};
}

const Articulation& JointCalled(const SceneAnnotations& known, const std::string& name) {
  const auto found = std::ranges::find_if(
      known.articulations, [&](const Articulation& joint) { return joint.joint.ends_with(name); });
  EXPECT_NE(found, known.articulations.end()) << name;
  return *found;
}

TEST(SceneAnnotations, ATableIsASupportWithAFreeTop) {
  const SceneAnnotations known =
      DeriveAnnotations({.name = "table", .base = "tabletop", .add_floor = true});
  ASSERT_FALSE(known.supports.empty());
  const SupportFace& top = known.supports.front();
  EXPECT_NEAR(top.free_area, 4 * top.face.half_x * top.face.half_y, 1e-9);
  EXPECT_THAT(known.articulations, IsEmpty());
  EXPECT_FALSE(known.lights.empty());
}

TEST(SceneAnnotations, ObjectsReduceTheFreeAreaOfATable) {
  SceneSpec spec{.name = "table", .base = "tabletop", .add_floor = true};
  const double before = DeriveAnnotations(spec).supports.front().free_area;
  spec.objects.push_back(Primitive("block", Shape::kBox, {0.12, 0.2, 0.05}));
  spec.objects.back().pos = {0.125, 0.205, 0.51};  // beside the middle of the table
  spec.objects.back().fixed = true;
  const double after = DeriveAnnotations(spec).supports.front().free_area;
  EXPECT_NEAR(before - after, 0.24 * 0.4, 0.05);
}

TEST(SceneAnnotations, DoorsAndDrawersAreFoundWithTheirHandles) {
  const SceneAnnotations known = DeriveAnnotations(WithModel("cabinet", {0.3, 0, 0.5}));
  ASSERT_EQ(known.articulations.size(), 2u);
  const Articulation& drawer = JointCalled(known, "drawer_slide");
  EXPECT_EQ(drawer.kind, ArticulationKind::kSlide);
  EXPECT_GT(drawer.range[1], drawer.range[0]);
  EXPECT_THAT(drawer.handle_geoms,
              UnorderedElementsAre("cabinet_drawer_handle", "cabinet_drawer_handle_left",
                                   "cabinet_drawer_handle_right"));
  const Articulation& door = JointCalled(known, "door_hinge");
  EXPECT_EQ(door.kind, ArticulationKind::kHinge);
  EXPECT_THAT(door.handle_geoms, Contains("cabinet_door_handle"));
  EXPECT_NEAR(std::abs(door.axis.z()), 1, 1e-9);
}

TEST(SceneAnnotations, ADrawerIsAContainerThatItsJointMoves) {
  const SceneAnnotations known = DeriveAnnotations(WithModel("cabinet", {0.3, 0, 0.5}));
  const auto drawer = std::ranges::find_if(known.containers, [](const Container& container) {
    return container.moved_by.ends_with("drawer_slide");
  });
  ASSERT_NE(drawer, known.containers.end());
  EXPECT_NEAR(drawer->opening.z(), 1, 1e-9);
}

TEST(SceneAnnotations, ATrayIsAContainerThatOpensUpwards) {
  const SceneAnnotations known = DeriveAnnotations(WithModel("tray", {0, 0, 0.46}));
  ASSERT_EQ(known.containers.size(), 1u);
  EXPECT_THAT(known.containers[0].body, ::testing::HasSubstr("tray"));
  EXPECT_NEAR(known.containers[0].opening.z(), 1, 1e-9);
  EXPECT_EQ(known.containers[0].moved_by, "");
  ASSERT_EQ(known.objects.size(), 1u);
  EXPECT_EQ(known.objects[0].category, "tray");
}

TEST(SceneAnnotations, SolidObjectsAreNotContainers) {
  SceneSpec spec{.name = "solid", .timestep = 0.002, .add_floor = true, .add_skybox = false};
  spec.objects.push_back(Primitive("cube", Shape::kBox, {0.1, 0.1, 0.1}));
  spec.objects.push_back(Primitive("ball", Shape::kSphere, {0.1, 0, 0}));
  const SceneAnnotations known = DeriveAnnotations(spec);
  EXPECT_THAT(known.containers, IsEmpty());
  EXPECT_THAT(known.objects[0].words, ElementsAre("box"));
  EXPECT_EQ(known.objects[1].category, "sphere");
}

}  // namespace
}  // namespace robocell
