#include "robocell/scenes/handle_names.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/mujoco/names.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/scenes/scene_annotations.h"

namespace robocell {
namespace {

TEST(HandleNames, TheNameOfAnObjectMakesNoHandles) {
  SceneSpec spec = EmptyScene();
  for (const std::string name : {"unit", "door_handle_rig", "knob"}) {
    spec.objects.push_back(
        {.name = name, .mjcf_path = "drawer_unit", .pos = Vec3{}, .fixed = true});
  }
  const Scene scene = Scene::Build(spec);
  const mjModel* m = scene.model();
  int handles = 0;
  for (int g = 0; g < m->ngeom; ++g) {
    const std::string name = ElementName(m, mjOBJ_GEOM, g);
    if (!name.starts_with("unit_")) continue;
    const std::string own = name.substr(5);
    handles += internal::IsHandleGeom(scene, g);
    for (const std::string other : {"door_handle_rig_", "knob_"}) {
      const int same = FindId(m, mjOBJ_GEOM, other + own);
      EXPECT_EQ(internal::IsHandleGeom(scene, same), internal::IsHandleGeom(scene, g)) << own;
    }
  }
  EXPECT_EQ(handles, 9);  // three parts of each of the three handles
  for (const Articulation& joint : DeriveAnnotations(scene).articulations)
    EXPECT_EQ(joint.handle_geoms.size(), 3u) << joint.joint;
}

}  // namespace
}  // namespace robocell
