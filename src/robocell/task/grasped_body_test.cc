#include "robocell/task/grasped_body.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/scene.h"
#include "robocell/scenes/handle_geoms.h"
#include "robocell/task/grasp_generator.h"

namespace robocell::internal {
namespace {

Scene Cabinet() {
  SceneSpec spec{.name = "c", .timestep = 0.002, .add_floor = true, .add_skybox = false};
  spec.objects.push_back({.name = "handle_box", .mjcf_path = "cabinet", .fixed = true});
  Scene scene = Scene::Build(spec);
  scene.Reset();
  return scene;
}

TEST(FindGraspedBody, ADoorIsGraspedAndItsFrameIsInTheWay) {
  const Scene scene = Cabinet();
  const mjModel* m = scene.model();
  const GraspedBody door = FindGraspedBody(scene, "handle_box_door");
  EXPECT_EQ(door.object, "handle_box");
  std::vector<std::string> own, others;
  for (const int g : door.geoms)
    own.push_back(NameInObject(scene, door.body, ElementName(m, mjOBJ_GEOM, g)));
  for (const int g : door.other_geoms)
    others.push_back(NameInObject(scene, door.body, ElementName(m, mjOBJ_GEOM, g)));
  EXPECT_THAT(own, testing::UnorderedElementsAre("door_panel", "door_handle", "door_handle_low",
                                                 "door_handle_high"));
  EXPECT_THAT(others, testing::IsSupersetOf({"top", "shelf", "drawer_front", "drawer_handle"}));
  EXPECT_EQ(FindGraspedBody(scene, "handle_box").name,
            scene.compiled()->object("handle_box").root_body);
}

// The object's name, handle_box, says nothing about its parts.
TEST(FindGraspedBody, HandlesAreThoseOfTheModel) {
  EXPECT_THAT(HandleGeomsOf(Cabinet(), "handle_box_door"),
              testing::UnorderedElementsAre("handle_box_door_handle", "handle_box_door_handle_low",
                                            "handle_box_door_handle_high"));
}

TEST(FindGraspedBody, RejectsUnknownNames) {
  try {
    FindGraspedBody(Cabinet(), "handle_bx");
    FAIL();
  } catch (const NotFoundError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("Did you mean 'handle_box'?"));
  }
}

}  // namespace
}  // namespace robocell::internal
