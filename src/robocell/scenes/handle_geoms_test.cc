#include "robocell/scenes/handle_geoms.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <set>
#include <string>

#include "robocell/mujoco/names.h"
#include "robocell/scenes/scene_annotations.h"

namespace robocell::internal {
namespace {

Scene Cabinet(const std::string& name) {
  SceneSpec spec{.name = "c", .timestep = 0.002, .add_floor = true, .add_skybox = false};
  spec.objects.push_back({.name = name, .mjcf_path = "cabinet", .fixed = true});
  Scene scene = Scene::Build(spec);
  scene.Reset();
  return scene;
}

// Names of handles without the object's name.
std::set<std::string> HandlesOf(const Scene& scene, const std::string& object) {
  const mjModel* m = scene.model();
  std::set<std::string> names;
  for (int g = 0; g < m->ngeom; ++g)
    if (IsHandleGeom(scene, g))
      names.insert(ElementName(m, mjOBJ_GEOM, g).substr(object.size() + 1));
  return names;
}

// The same model has the same handles under every name, wherever robocell looks for them.
TEST(HandleGeoms, TheNameOfTheObjectMakesNoHandles) {
  const std::set<std::string> expected = HandlesOf(Cabinet("plain"), "plain");
  EXPECT_TRUE(expected.contains("door_handle"));
  EXPECT_FALSE(expected.contains("door_panel"));
  for (const std::string name : {"door_handle_rig", "knob_panel"}) {
    const Scene scene = Cabinet(name);
    EXPECT_EQ(HandlesOf(scene, name), expected);
    std::set<std::string> annotated;
    for (const Articulation& joint : DeriveAnnotations(scene).articulations)
      for (const std::string& geom : joint.handle_geoms)
        annotated.insert(geom.substr(name.size() + 1));
    EXPECT_EQ(annotated, expected);
  }
}

TEST(HandleGeoms, NamesInObjectsLoseThePrefixOfTheirObjectOnly) {
  const Scene scene = Cabinet("door");
  const mjModel* m = scene.model();
  const int door = FindId(m, mjOBJ_BODY, "door_door");
  ASSERT_GT(door, 0);
  EXPECT_EQ(NameInObject(scene, door, "door_door_handle"), "door_handle");
  EXPECT_EQ(NameInObject(scene, 0, "door_door_handle"), "door_door_handle");
  EXPECT_EQ(NameInObject(scene, door, "other"), "other");
}

}  // namespace
}  // namespace robocell::internal
