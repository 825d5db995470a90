#include "robocell/task/held_paths.h"

#include <gtest/gtest.h>

#include <cmath>

#include "robocell/scene/testing/scenes.h"
#include "robocell/scenes/relations.h"
#include "robocell/task/held_relation.h"

namespace robocell::internal {
namespace {

TEST(HeldPaths, LeadIntoTheHoleInFineSteps) {
  RegisterTaskRelations();
  SceneSpec spec = EmptyScene();
  SceneObject peg = BoxObject("peg", {0, 0, 0.3});
  peg.size = Vec3{0.0145, 0.0145, 0.05};
  spec.objects.push_back(peg);
  spec.objects.push_back({.name = "block", .mjcf_path = "square_hole", .pos = Vec3{0.3, 0, 0.021}});
  Scene scene = Scene::Build(spec);
  scene.Reset();
  const StatedRelation stated = ParseRelation("peg inserted block");
  ASSERT_TRUE(HasHeldPaths(stated));
  EXPECT_FALSE(HasHeldPaths(ParseRelation("peg on block")));
  const auto bound = BindRelation(scene, stated);
  const std::vector<HeldPath> paths = HeldPaths(scene, stated, *bound, scene.body_pose("peg"));
  ASSERT_EQ(paths.size(), 4u);
  for (const HeldPath& path : paths) {
    for (size_t i = 1; i < path.size(); ++i)
      EXPECT_TRUE(path[i].is_close(path[i - 1], 0.06, 0.006));
    scene.SetBodyPose("peg", path.front());
    scene.Forward();
    EXPECT_TRUE(scene.contacts("peg").empty()) << "over the hole";
    scene.SetBodyPose("peg", path.back());
    scene.Forward();
    EXPECT_TRUE(bound->Holds());
  }
}

}  // namespace
}  // namespace robocell::internal
