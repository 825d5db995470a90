// Tests every available Menagerie robot: alone as a robot, twice, and as the base of a scene.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <algorithm>

#include "robocell/assets/resolve.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/model_compare.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/menagerie.h"

namespace robocell {
namespace {

bool Collides(const mjModel* m, int body) {
  const int first = m->body_geomadr[body];
  for (int g = first; g < first + m->body_geomnum[body]; ++g) {
    if (m->geom_contype[g] || m->geom_conaffinity[g]) return true;
  }
  return false;
}

// Counts pairs of a body that is fixed to the world and one that moves on it, which the engine lets
// touch.
int FirstJointsThatTouch(const mjModel* m) {
  int count = 0;
  for (int b = 1; b < m->nbody; ++b) {
    const int parent = m->body_parentid[b], *end = m->exclude_signature + m->nexclude;
    if (parent == 0 || m->body_jntnum[b] == 0 || m->body_weldid[parent] != 0) continue;
    const int pair = (parent << 16) + b;
    if (Collides(m, b) && Collides(m, parent) && std::find(end - m->nexclude, end, pair) == end)
      ++count;
  }
  return count;
}

class Menagerie : public ::testing::TestWithParam<std::string> {};

TEST_P(Menagerie, RobotKeepsAllItsElements) {
  REQUIRE_MENAGERIE(GetParam());
  const std::string file = menagerie::ModelPath(GetParam());
  const ModelPtr alone(mj_loadXML(file.c_str(), nullptr, nullptr, 0));
  SceneSpec spec = EmptyScene();
  spec.add_floor = spec.add_skybox = false;
  for (int i = 0; i < 2; ++i)
    spec.robots.push_back({.path = file,
                           .prefix = fmt::format("r{}_", i),
                           .pos = {0, 2.0 * i, 0},
                           .control_modes = std::vector{CtrlMode::kPosition}});
  const Scene scene = Scene::Build(spec);
  const mjModel* m = scene.model();
  EXPECT_EQ(m->nq, 2 * alone->nq);
  EXPECT_EQ(m->nu, 2 * alone->nu);
  EXPECT_EQ(m->nbody, 2 * alone->nbody - 1);
  EXPECT_EQ(m->ngeom, 2 * alone->ngeom);
  EXPECT_EQ(m->neq, 2 * alone->neq);
  EXPECT_EQ(m->ntendon, 2 * alone->ntendon);
  EXPECT_EQ(m->nexclude, 2 * (alone->nexclude + FirstJointsThatTouch(alone.get())));
  EXPECT_EQ(m->nsensor, 2 * alone->nsensor);
  const int own_home = mj_name2id(alone.get(), mjOBJ_KEY, "home") >= 0 ? 1 : 0;
  EXPECT_EQ(m->nkey, 1 + 2 * (alone->nkey - own_home));
  // The first robot equals the file's, number by number.
  EXPECT_EQ(LargestDifference(alone->jnt_range, m->jnt_range, 2 * alone->njnt), 0);
  EXPECT_EQ(LargestDifference(alone->dof_damping, m->dof_damping, alone->nv), 0);
  EXPECT_LT(LargestDifference(alone->body_inertia, m->body_inertia, 3 * alone->nbody), 1e-12);
  EXPECT_LT(LargestDifference(alone->body_pos, m->body_pos, 3 * alone->nbody), 1e-12);
  EXPECT_EQ(LargestDifference(alone->actuator_gainprm, m->actuator_gainprm, mjNGAIN * alone->nu),
            0);
  EXPECT_EQ(LargestDifference(alone->actuator_forcerange, m->actuator_forcerange, 2 * alone->nu),
            0);
}

TEST_P(Menagerie, SceneFileCanBeABase) {
  REQUIRE_MENAGERIE(GetParam());
  SceneSpec spec;
  spec.base = "menagerie:" + GetParam() + "/scene.xml";
  spec.objects.push_back(BoxObject("cube", {0.6, 0.3, 0.02}));
  Scene scene = Scene::Build(spec);
  const ModelPtr alone(mj_loadXML(assets::Resolve(*spec.base).c_str(), nullptr, nullptr, 0));
  EXPECT_EQ(scene.model()->nu, alone->nu);
  if (alone->nkey > 0 && alone->nq == scene.model()->nq - 7) {
    EXPECT_EQ(LargestDifference(alone->key_qpos, scene.data()->qpos, alone->nq), 0)
        << "its home is the scene's";
  }
  EXPECT_TRUE(scene.StepN(200).ok());
}

INSTANTIATE_TEST_SUITE_P(Robots, Menagerie, ::testing::ValuesIn(MenagerieTestModels()),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace robocell
