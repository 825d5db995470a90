#include "robocell/scene/carry_over.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <map>

#include "robocell/assets/resolve.h"
#include "robocell/base/rng.h"
#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/random_scenes.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/scene/testing/workplace.h"

namespace robocell::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// All numbers of the state by the element that they belong to.
using Numbers = std::map<std::string, std::vector<double>>;

void Add(Numbers& out, const std::string& name, const double* values, int count) {
  out[name] = std::vector<double>(values, values + count);
}

Numbers NumbersOf(const Scene& scene) {
  const mjModel* m = scene.model();
  const mjData* d = scene.data();
  Numbers out{{"time", {d->time}}};
  for (int j = 0; j < m->njnt; ++j) {
    const std::string name = ElementName(m, mjOBJ_JOINT, j);
    if (name.empty()) continue;
    const int type = m->jnt_type[j];
    const int nq = type == mjJNT_FREE ? 7 : type == mjJNT_BALL ? 4 : 1;
    const int nv = type == mjJNT_FREE ? 6 : type == mjJNT_BALL ? 3 : 1, dof = m->jnt_dofadr[j];
    Add(out, name + " qpos", d->qpos + m->jnt_qposadr[j], nq);
    Add(out, name + " qvel", d->qvel + dof, nv);
    Add(out, name + " warmstart", d->qacc_warmstart + dof, nv);
    Add(out, name + " force", d->qfrc_applied + dof, nv);
  }
  for (int a = 0; a < m->nactuator; ++a) {
    const std::string name = ElementName(m, mjOBJ_ACTUATOR, a);
    if (!name.empty()) Add(out, name + " ctrl", d->ctrl + m->actuator_ctrladr[a], 1);
    const bool off = m->opt.disableactuator >> m->actuator_group[a] & 1;
    if (!name.empty()) out[name + " off"] = {off ? 1.0 : 0.0};
  }
  for (int b = 0; b < m->nbody; ++b) {
    const std::string name = ElementName(m, mjOBJ_BODY, b);
    if (!name.empty()) Add(out, name + " wrench", d->xfrc_applied + 6 * b, 6);
    const int mocap = m->body_mocapid[b];
    if (mocap >= 0) Add(out, name + " mocap", d->mocap_pos + 3 * mocap, 3);
  }
  return out;
}

// Returns the differences between `before` and `after`, to the bit.
std::vector<std::string> Changed(const Numbers& before, const Numbers& after) {
  std::vector<std::string> changed;
  for (const auto& [name, values] : before) {
    const auto at = after.find(name);
    if (at == after.end() || at->second != values) changed.push_back(name);
  }
  return changed;
}

TEST(CarryOver, InRandomScenesSurvivorsStayToTheBit) {
  RandomScenes scenes;
  for (uint64_t seed = 0; seed < 25; ++seed) {
    Rng rng = Rng::Stream(seed, "survivors");
    Scene scene = Scene::Build(scenes.Next(rng));
    LiveOn(scene, rng);
    const std::vector<double> state = scene.state();
    const std::string model = SaveBinaryString(scene.model());
    const Numbers before = NumbersOf(scene);

    scene.AddObject(scenes.Object(rng, "new"));
    EXPECT_THAT(Changed(before, NumbersOf(scene)), IsEmpty()) << "seed " << seed;
    const Numbers all = NumbersOf(scene);
    if (const auto names = scene.object_names(); names.size() > 1) {
      const SceneObject first = scene.spec().objects[0];
      scene.RemoveObject(first.name);
      EXPECT_THAT(Changed(NumbersOf(scene), all), IsEmpty()) << "seed " << seed;
      continue;  // the order of the objects differs from here on
    }
    scene.RemoveObject("new");
    EXPECT_TRUE(scene.state() == state) << "seed " << seed;
    EXPECT_TRUE(SaveBinaryString(scene.model()) == model) << "seed " << seed;
  }
}

// The reference is a scene without additions. Another body changes the rounding of the others'
// motion.
TEST(CarryOver, SurvivorsContinueUnchanged) {
  RandomScenes scenes;
  for (uint64_t seed = 0; seed < 10; ++seed) {
    Rng rng = Rng::Stream(seed, "go on");
    const SceneSpec spec = scenes.Next(rng);
    Scene scene = Scene::Build(spec), twin = Scene::Build(spec);
    LiveOn(scene, rng);
    twin.SetState(scene.state());
    scene.AddObject(BoxObject("far", {30, 30, 0.02}));
    EXPECT_TRUE(scene.StepN(50).ok());
    EXPECT_TRUE(twin.StepN(50).ok());
    for (const std::string& body : twin.body_names())
      EXPECT_TRUE(scene.body_pose(body).is_close(twin.body_pose(body), 1e-9, 1e-9)) << body;
    scene.RemoveObject("far");  // the model of the twin again
    const std::vector<double> state = scene.state();
    twin.SetState(state);
    EXPECT_TRUE(scene.StepN(100).ok());
    EXPECT_TRUE(twin.StepN(100).ok());
    EXPECT_TRUE(scene.state() == twin.state()) << "seed " << seed;
  }
}

TEST(CarryOver, KeepsEditsOfTheModel) {
  SceneSpec spec = EmptyScene();
  spec.robots.push_back(
      {.config = RobotConfig::Load(assets::BuiltinRobotFile("rc7")), .prefix = "r_"});
  spec.objects.push_back(BoxObject("cube", {0.4, 0, 0.02}));
  Scene scene = Scene::Build(spec);
  mjModel* m = scene.mutable_model();
  const int geom = RequireId(m, mjOBJ_GEOM, "cube_geom", "");
  m->geom_rgba[4 * geom + 1] = 0.25F;
  m->geom_friction[3 * geom] = 0.125;
  m->geom_contype[geom] = 2;
  m->body_mass[RequireId(m, mjOBJ_BODY, "cube", "")] = 0.75;
  m->actuator_gainprm[mjNGAIN * 2] = 123;
  m->actuator_ctrlrange[2 * 3] = -0.5;
  m->dof_damping[m->jnt_dofadr[RequireId(m, mjOBJ_JOINT, "r_joint2", "")]] = 7;
  m->opt.gravity[2] = -1.62;
  m->opt.timestep = 0.001;
  m->opt.disableactuator ^= 1 << m->actuator_group[0];
  m->vis.headlight.ambient[0] = 0.75F;
  const std::string servo = ElementName(m, mjOBJ_ACTUATOR, 0);
  const int groups = m->opt.disableactuator;
  scene.AddObject(BoxObject("other", {0.4, 0.3, 0.02}));
  scene.RemoveObject("cube");
  scene.AddObject(BoxObject("cube", {0.4, 0, 0.02}));
  const mjModel* n = scene.model();
  EXPECT_EQ(n->opt.gravity[2], -1.62);
  EXPECT_EQ(n->opt.timestep, 0.001);
  EXPECT_EQ(n->opt.disableactuator, groups);
  EXPECT_EQ(n->actuator_gainprm[mjNGAIN * 2], 123);
  EXPECT_EQ(n->actuator_ctrlrange[2 * 3], -0.5);
  EXPECT_EQ(n->dof_damping[n->jnt_dofadr[RequireId(n, mjOBJ_JOINT, "r_joint2", "")]], 7);
  EXPECT_EQ(n->vis.headlight.ambient[0], 0.75F);
  // An object that was removed and added again has the values of its spec.
  EXPECT_EQ(n->body_mass[RequireId(n, mjOBJ_BODY, "cube", "")], 0.1);

  m = scene.mutable_model();
  const int other = RequireId(m, mjOBJ_GEOM, "other_geom", "");
  m->geom_rgba[4 * other + 1] = 0.25F;
  m->geom_friction[3 * other] = 0.125;
  m->geom_contype[other] = 2;
  scene.RemoveObject("cube");
  const int now = RequireId(scene.model(), mjOBJ_GEOM, "other_geom", "");
  EXPECT_EQ(scene.model()->geom_rgba[4 * now + 1], 0.25F);
  EXPECT_EQ(scene.model()->geom_friction[3 * now], 0.125);
  EXPECT_EQ(scene.model()->geom_contype[now], 2);
}

TEST(CarryOver, KeepsEditsOfPairsAndSensorsAndSumsMassesAgain) {
  ModelFolder folder;
  const std::string rig = folder.Write("rig", R"(<worldbody><body name="rig">
      <geom name="plate" size="0.1"/><site name="here"/>
      <body name="arm" pos="0.3 0 0"><joint axis="0 0 1"/><geom name="ball" size="0.1"/>
      </body></body></worldbody>
      <contact><pair geom1="plate" geom2="ball"/></contact>
      <sensor><force site="here"/></sensor>)");
  SceneSpec spec = EmptyScene();
  spec.objects = {{.name = "rig", .mjcf_path = rig}, {.name = "twin", .mjcf_path = rig}};
  Scene scene = Scene::Build(spec);
  mjModel* m = scene.mutable_model();
  ASSERT_EQ(m->npair, 2);
  const auto number_of = [](const mjModel* model, const char* geom) {
    const int id = RequireId(model, mjOBJ_GEOM, geom, "");
    return model->pair_geom1[0] == id || model->pair_geom2[0] == id ? 0 : 1;
  };
  m->pair_friction[5 * number_of(m, "twin_ball")] = 0.125;
  m->sensor_noise[1] = 0.25;
  m->body_mass[RequireId(m, mjOBJ_BODY, "twin_arm", "")] = 0.75;
  mj_setConst(m, scene.data());
  const double mass = m->body_subtreemass[RequireId(m, mjOBJ_BODY, "twin_rig", "")];
  const double all = m->body_subtreemass[0];
  scene.AddObject(BoxObject("cube", {0.4, 0, 0.02}));
  const mjModel* n = scene.model();
  EXPECT_EQ(n->pair_friction[5 * number_of(n, "twin_ball")], 0.125);
  EXPECT_EQ(n->sensor_noise[1], 0.25);
  EXPECT_EQ(n->body_subtreemass[RequireId(n, mjOBJ_BODY, "twin_rig", "")], mass);
  EXPECT_DOUBLE_EQ(n->body_subtreemass[0], all + 0.1);
  scene.RemoveObject("rig");
  EXPECT_EQ(scene.model()->pair_friction[0], 0.125);
  EXPECT_EQ(scene.model()->sensor_noise[0], 0.25);
}

}  // namespace
}  // namespace robocell::internal
