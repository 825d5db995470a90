#include "robocell/render/pedestal_feet.h"

#include <gtest/gtest.h>

#include "robocell/mujoco/forward.h"
#include "robocell/mujoco/owners.h"
#include "robocell/render/mjv_scene.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/scenes.h"

namespace robocell::internal {
namespace {

// Returns the drawn pedestal's bottom and top, in the world.
std::pair<double, double> Drawn(const Scene& scene, bool feet) {
  const mjModel* m = scene.model();
  MjvScene drawn(m);
  mjvOption option;
  mjv_defaultOption(&option);
  mjvCamera camera;
  mjv_defaultCamera(&camera);
  mjv_updateScene(m, scene.data(), &option, nullptr, &camera, mjCAT_ALL, drawn.get());
  if (feet) PedestalFeet(m).ReachDown(m, scene.data(), option, drawn.get());
  const int pedestal = mj_name2id(m, mjOBJ_GEOM, "r_pedestal");
  for (int i = 0; i < drawn.get()->ngeom; ++i) {
    const mjvGeom& geom = drawn.get()->geoms[i];
    if (geom.objtype == mjOBJ_GEOM && geom.objid == pedestal)
      return {geom.pos[2] - geom.size[2], geom.pos[2] + geom.size[2]};
  }
  ADD_FAILURE() << "no pedestal";
  return {};
}

SceneSpec OnAPedestal(const std::string& arm, double height, bool floor) {
  SceneSpec spec{.timestep = 0.002, .add_floor = floor, .add_skybox = false};
  spec.robots.push_back({.path = arm,
                         .prefix = "r_",
                         .base = BaseConfig{.kind = BaseKind::kMocap, .size = Vec3{0.2, 0.2, 0.25}},
                         .pos = {0, 0, height}});
  return spec;
}

TEST(PedestalFeet, ReachDownToTheSupport) {
  ModelFolder folder;
  const std::string arm = folder.Write("arm", kTwoJointArm);
  for (const double height : {0.0, 0.2, 0.7}) {
    const Scene scene = Scene::Build(OnAPedestal(arm, height, true));
    EXPECT_NEAR(Drawn(scene, false).first, height, 1e-6);
    const auto [bottom, top] = Drawn(scene, true);
    EXPECT_NEAR(bottom, 0, 1e-6);
    EXPECT_NEAR(top, height + 0.25, 1e-6);
  }
  SceneSpec spec = OnAPedestal(arm, 0.7, true);
  spec.objects.push_back(BoxObject("bench", {0, 0, 0.1}));
  const Scene scene = Scene::Build(spec);
  const mjModel* m = scene.model();
  const int box = mj_name2id(m, mjOBJ_GEOM, "bench_geom");
  EXPECT_NEAR(Drawn(scene, true).first, 0.1 + m->geom_size[3 * box + 2], 1e-6);
}

TEST(PedestalFeet, StayWithoutASupport) {
  ModelFolder folder;
  const std::string arm = folder.Write("arm", kTwoJointArm);
  EXPECT_NEAR(Drawn(Scene::Build(OnAPedestal(arm, 0.7, false)), true).first, 0.7, 1e-6);
}

}  // namespace
}  // namespace robocell::internal
