// Objects that come and go while a scene runs: what is new, what stays to the bit, what is refused.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <map>

#include "robocell/assets/resolve.h"
#include "robocell/base/error.h"
#include "robocell/base/rng.h"
#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/random_scenes.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// All numbers of the state, and what they belong to.
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

// Returns what differs between `before` and `after`, to the bit.
std::vector<std::string> Changed(const Numbers& before, const Numbers& after) {
  std::vector<std::string> changed;
  for (const auto& [name, values] : before) {
    const auto at = after.find(name);
    if (at == after.end() || at->second != values) changed.push_back(name);
  }
  return changed;
}

// Steps with random controls, forces and switches.
void LiveOn(Scene& scene, Rng& rng) {
  const mjModel* m = scene.model();
  mjData* d = scene.data();
  for (int i = 0; i < m->nu; ++i) {
    const mjtNum* range = m->actuator_ctrlrange + 2 * i;
    d->ctrl[i] = m->actuator_ctrllimited[i] ? rng.Uniform(range[0], range[1]) : rng.Uniform(-1, 1);
  }
  for (int i = 0; i < m->nv; ++i) d->qfrc_applied[i] = rng.Uniform(-0.01, 0.01);
  for (int i = 6; i < 6 * m->nbody; ++i) d->xfrc_applied[i] = rng.Uniform(-0.01, 0.01);
  for (int i = 0; i < m->neq; ++i) d->eq_active[i] = rng.UniformInt(2) == 0;
  for (int i = 0; i < 3 * m->nmocap; ++i) d->mocap_pos[i] += rng.Uniform(-0.001, 0.001);
  EXPECT_TRUE(scene.StepN(1 + static_cast<int>(rng.UniformInt(40))).ok());
}

TEST(AddRemove, AnObjectComesAndGoesWhileASceneRuns) {
  Scene scene = Scene::Build(EmptyScene());
  EXPECT_TRUE(scene.StepN(10).ok());
  const uint64_t generation = scene.generation();
  scene.AddObject(BoxObject("cube", {0.4, 0, 0.02}));
  EXPECT_THAT(scene.object_names(), ElementsAre("cube"));
  EXPECT_GT(scene.generation(), generation);
  EXPECT_DOUBLE_EQ(scene.time(), 0.02);
  EXPECT_TRUE(scene.body_pose("cube").is_close(Pose(Eigen::Vector3d(0.4, 0, 0.02)), 0, 0));
  EXPECT_TRUE(scene.StepN(100).ok());
  EXPECT_THAT(scene.contacts("cube"), ::testing::SizeIs(4));
  EXPECT_NEAR(scene.body_pose("cube").translation().z(), 0.02, 1e-3);
  scene.RemoveObject("cube");
  EXPECT_THAT(scene.object_names(), IsEmpty());
  EXPECT_THAT(scene.contacts(), IsEmpty());
  EXPECT_EQ(scene.model()->nbody, 1);
  EXPECT_TRUE(scene.Step().ok());
}

TEST(AddRemove, InRandomScenesSurvivorsStayToTheBit) {
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
      continue;  // the order of the objects is another one from here on
    }
    scene.RemoveObject("new");
    EXPECT_TRUE(scene.state() == state) << "seed " << seed;
    EXPECT_TRUE(SaveBinaryString(scene.model()) == model) << "seed " << seed;
  }
}

TEST(AddRemove, AddingThenRemovingGivesBackStateAndModel) {
  RandomScenes scenes;
  for (uint64_t seed = 100; seed < 120; ++seed) {
    Rng rng = Rng::Stream(seed, "there and back");
    Scene scene = Scene::Build(scenes.Next(rng));
    LiveOn(scene, rng);
    const std::vector<double> state = scene.state();
    const std::string model = SaveBinaryString(scene.model());
    scene.AddObject(scenes.Object(rng, "new"));
    scene.RemoveObject("new");
    EXPECT_TRUE(scene.state() == state) << "seed " << seed;
    EXPECT_TRUE(SaveBinaryString(scene.model()) == model) << "seed " << seed;
  }
}

// Against a scene in which nothing was added. Another body rounds the others' motion differently.
TEST(AddRemove, SurvivorsGoOnAsIfNothingHadHappened) {
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

TEST(AddRemove, WhatWasWrittenToTheModelStays) {
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
  // An object that was removed and added again is as its spec says.
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

TEST(AddRemove, WhatWasWrittenToPairsAndSensorsStaysAndMassesAreSummedAnew) {
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

TEST(AddRemove, LaterResetsAndSavedFilesHaveTheObject) {
  SceneSpec spec = EmptyScene();
  spec.cameras.push_back({.name = "front", .pos = Vec3{2, 0, 1}, .fovy = 50});
  Scene scene = Scene::Build(spec);
  scene.AddObject(BoxObject("cube", {0.4, 0, 0.5}));
  int calls = 0;
  scene.AddResetHook([&](ResetContext& reset) {
    ++calls;
    reset.scene.SetBodyPose("cube", Pose(Eigen::Vector3d(0.2, 0, 0.1)));
  });
  EXPECT_TRUE(scene.StepN(50).ok());
  scene.AddObject(BoxObject("other", {0.6, 0, 0.5}));
  scene.Reset();
  EXPECT_EQ(calls, 1);
  EXPECT_EQ(scene.body_pose("cube").translation().x(), 0.2);
  EXPECT_EQ(scene.body_pose("other").translation().z(), 0.5);
  const ModelPtr loaded = Compile(ParseXmlString(scene.ToXml()).get());
  EXPECT_GE(FindId(loaded.get(), mjOBJ_BODY, "cube"), 0);
  EXPECT_GE(FindId(loaded.get(), mjOBJ_BODY, "other"), 0);
  EXPECT_EQ(loaded->nkey, 1);
  // To the bit as a scene that was built so.
  Scene fresh = Scene::Build(scene.spec());
  fresh.AddResetHook([](ResetContext& reset) {
    reset.scene.SetBodyPose("cube", Pose(Eigen::Vector3d(0.2, 0, 0.1)));
  });
  fresh.Reset();
  EXPECT_TRUE(scene.StepN(200).ok());
  EXPECT_TRUE(fresh.StepN(200).ok());
  EXPECT_TRUE(scene.state() == fresh.state());
}

TEST(AddRemove, AHookMayAddObjects) {
  Scene scene = Scene::Build(EmptyScene());
  scene.AddResetHook([](ResetContext& reset) {
    if (reset.scene.object_names().empty())
      reset.scene.AddObject(BoxObject("cube", {0.4, 0, 0.02}));
  });
  scene.Reset();
  scene.Reset();
  EXPECT_THAT(scene.object_names(), ElementsAre("cube"));
  EXPECT_TRUE(scene.StepN(100).ok());
}

// Nothing of a scene is another one after `change` has thrown.
template <class Exception, class Change>
std::string MessageOfRefused(Scene& scene, const Change& change) {
  const std::vector<double> state = scene.state();
  const uint64_t generation = scene.generation();
  const mjModel* model = scene.model();
  const mjData* data = scene.data();
  const std::string saved = scene.ToXml();
  std::string message;
  try {
    change();
    ADD_FAILURE() << "nothing was thrown";
  } catch (const Exception& error) {
    message = error.what();
  }
  EXPECT_EQ(scene.generation(), generation);
  EXPECT_EQ(scene.model(), model);
  EXPECT_EQ(scene.data(), data);
  EXPECT_TRUE(scene.state() == state);
  EXPECT_EQ(scene.ToXml(), saved);
  EXPECT_TRUE(scene.Step().ok());
  return message;
}

TEST(AddRemove, WhatIsRefusedChangesNothing) {
  ModelFolder folder;
  SceneSpec spec = EmptyScene();
  const std::string table = folder.Write("table", R"(<worldbody><body name="table">
      <geom type="box" size="0.4 0.4 0.2" pos="0 0 0.2"/><site name="table_top" pos="0 0 0.4"/>
      </body></worldbody>)");
  spec.objects = {{.name = "table", .mjcf_path = table}, BoxObject("cube", {0.4, 0, 1})};
  spec.robots.push_back({.config = ArmConfig(folder.Write("arm", kTwoJointArm)),
                         .prefix = "r_",
                         .attach_to = {AttachKind::kSite, "table_table_top"}});
  Scene scene = Scene::Build(spec);
  EXPECT_TRUE(scene.StepN(20).ok());
  const auto add = [&](const SceneObject& object) {
    return [&scene, object] { scene.AddObject(object); };
  };
  EXPECT_EQ(MessageOfRefused<ArgumentError>(scene, add(BoxObject("cube", {}))),
            "scene 'test': there is an object 'cube' already; remove it first, or choose another "
            "name. The objects: table, cube");
  EXPECT_THAT(MessageOfRefused<SpecError>(scene, add(BoxObject("r_fore", {}))),
              HasSubstr("'r_fore'"));
  EXPECT_THAT(
      MessageOfRefused<SpecError>(scene, add({.name = "half", .shape = Shape::kBox})),
      HasSubstr("scene 'test': the object 'half' given to add_object is not valid, 4 problems:\n"
                "  size: a primitive needs its half sizes"));
  EXPECT_THAT(
      MessageOfRefused<NotFoundError>(scene, add({.name = "x", .mjcf_path = "no_such.xml"})),
      HasSubstr("no_such.xml"));
  SceneObject stuck = BoxObject("stuck", {});
  stuck.fixed = true;
  stuck.attach_to = {AttachKind::kBody, "r_for"};
  EXPECT_THAT(MessageOfRefused<NotFoundError>(scene, add(stuck)),
              HasSubstr("Did you mean 'r_fore'?"));
  EXPECT_EQ(MessageOfRefused<NotFoundError>(scene, [&] { scene.RemoveObject("cub"); }),
            "scene 'test': no object 'cub'. Its objects: table, cube. Did you mean 'cube'?");
  EXPECT_EQ(MessageOfRefused<ArgumentError>(scene, [&] { scene.RemoveObject("table"); }),
            "scene 'test': object 'table' cannot be removed: attached to it is robot 'r' (to site "
            "'table_table_top'). Remove objects that hang on it first; robots and cameras stay "
            "where they are, build another scene without them");
}

// Names do not say whose a frame is: `cup_big_handle` could be of `cup` as well.
TEST(AddRemove, WhatIsAttachedToAFrameOfAnotherObjectDoesNotHoldIt) {
  ModelFolder folder;
  const std::string cup = folder.Write("cup", R"(<worldbody><body name="cup">
      <geom size="0.05"/><frame name="big_lid" pos="0 0 0.1"><site/></frame></body></worldbody>)");
  const std::string big = folder.Write("big", R"(<worldbody><body name="cup"><geom size="0.1"/>
      <body name="side" pos="0.1 0 0"><geom size="0.02"/>
      <frame name="handle" pos="0.1 0 0"><site/></frame></body></body></worldbody>)");
  SceneSpec spec = EmptyScene();
  spec.objects = {{.name = "cup", .mjcf_path = cup, .pos = {1, 0, 0}},
                  {.name = "cup_big", .mjcf_path = big},
                  BoxObject("spoon", {})};
  spec.objects[2].fixed = true;
  spec.objects[2].attach_to = {AttachKind::kFrame, "cup_big_handle"};
  Scene scene = Scene::Build(spec);
  scene.RemoveObject("cup");
  EXPECT_THAT(scene.object_names(), ElementsAre("cup_big", "spoon"));
  EXPECT_THAT(MessageOfRefused<ArgumentError>(scene, [&] { scene.RemoveObject("cup_big"); }),
              HasSubstr("attached to it is object 'spoon' (to frame 'cup_big_handle')"));
  scene.RemoveObject("spoon");
  scene.AddObject(spec.objects[0]);
  SceneObject lid = BoxObject("lid", {});
  lid.fixed = true;
  lid.attach_to = {AttachKind::kFrame, "cup_big_lid"};
  scene.AddObject(lid);
  EXPECT_THAT(MessageOfRefused<ArgumentError>(scene, [&] { scene.RemoveObject("cup"); }),
              HasSubstr("attached to it is object 'lid' (to frame 'cup_big_lid')"));
  scene.RemoveObject("cup_big");
  EXPECT_THAT(scene.object_names(), ElementsAre("cup", "lid"));
}

// Objects are added by compiling the spec again, and its files may be others by then.
TEST(AddRemove, AFileThatChangedIsToldAndTheSceneStays) {
  ModelFolder folder;
  const auto cup = [](const char* mass) {
    return fmt::format(R"(<worldbody><body name="b"><freejoint/><geom size="0.1" mass="{}"/></body>
                       </worldbody>)",
                       mass);
  };
  SceneSpec spec = EmptyScene();
  const std::string file = folder.Write("cup", cup("1"));
  spec.objects = {{.name = "cup", .mjcf_path = file, .pos = {0, 0, 1}},
                  BoxObject("cube", {1, 0, 0.02})};
  Scene scene = Scene::Build(spec);
  const mjModel* model = scene.model();
  const std::string bytes = SaveBinaryString(model);
  folder.Write("cup", cup("1.25"));
  const std::string changed =
      "scene 'test': '" + file +
      "' has changed since the scene was compiled, and objects are added and removed by compiling "
      "it again, which would change what is there. Build the scene anew, or put the file back";
  ExpectThrow<Error>([&] { scene.AddObject(BoxObject("late", {1, 1, 0.02})); }, changed);
  ExpectThrow<Error>([&] { scene.RemoveObject("cube"); }, changed);
  EXPECT_EQ(scene.model(), model);
  EXPECT_TRUE(SaveBinaryString(scene.model()) == bytes);
  EXPECT_THAT(scene.object_names(), ElementsAre("cup", "cube"));
  scene.RemoveObject("cup");  // nothing else is made of it
  SceneObject again = spec.objects[0];
  again.name = "again";
  scene.AddObject(again);
  scene.RemoveObject("cube");
}

TEST(AddRemove, AFrozenModelKeepsItsObjects) {
  SceneSpec spec = EmptyScene();
  spec.objects.push_back(BoxObject("cube", {0.4, 0, 0.02}));
  const auto compiled = CompileScene(spec);
  compiled->Freeze();
  Scene scene = Scene::FromCompiled(compiled);
  const std::string message = MessageOfRefused<Error>(scene, [&] {
    scene.AddObject(BoxObject("other", {0.6, 0, 0.02}));
  });
  EXPECT_EQ(message,
            "scene 'test': object 'other' cannot be added: the compiled scene is frozen because it "
            "is shared between scenes. Build a scene of its own with Scene::Build (in Python "
            "Scene.build), or change the spec and compile it again");
  EXPECT_THAT(MessageOfRefused<Error>(scene, [&] { scene.RemoveObject("cube"); }),
              HasSubstr("object 'cube' cannot be removed: the compiled scene is frozen"));
}

class Follower : public SceneObserver {
 public:
  explicit Follower(Scene scene) : scene_(scene.inner()) {}
  void OnRebuild() override {
    const bool back = !seen.empty() && scene_.generation() < seen.back();
    seen.push_back(scene_.generation());
    if (fails || (back && fails_to_go_back)) throw Error("cannot follow");
  }
  std::vector<uint64_t> seen;
  bool fails = false, fails_to_go_back = false;

 private:
  Scene scene_;
};

TEST(AddRemove, AnObserverThatCannotFollowUndoesTheChange) {
  Scene scene = Scene::Build(EmptyScene());
  const auto first = std::make_shared<Follower>(scene), second = std::make_shared<Follower>(scene);
  scene.AddObserver(first);
  scene.AddObserver(second);
  second->fails = true;
  const uint64_t generation = scene.generation();
  EXPECT_EQ(MessageOfRefused<Error>(scene,
                                    [&] {
                                      scene.AddObject(BoxObject("cube", {0.4, 0, 0.02}));
                                    }),
            "cannot follow");
  ASSERT_EQ(first->seen.size(), 2U);
  EXPECT_GT(first->seen[0], generation);
  EXPECT_EQ(first->seen[1], generation);
  second->fails = false;
  scene.AddObject(BoxObject("cube", {0.4, 0, 0.02}));
  EXPECT_EQ(second->seen.back(), scene.generation());
}

TEST(AddRemove, OfAChangeThatIsUndoneEveryObserverIsTold) {
  Scene scene = Scene::Build(EmptyScene());
  const auto first = std::make_shared<Follower>(scene), second = std::make_shared<Follower>(scene),
             third = std::make_shared<Follower>(scene);
  for (const auto& follower : {first, second, third}) scene.AddObserver(follower);
  first->fails_to_go_back = true;
  third->fails = true;
  const uint64_t generation = scene.generation();
  EXPECT_THROW(scene.AddObject(BoxObject("cube", {0.4, 0, 0.02})), Error);
  for (const auto& follower : {first, second, third}) {
    ASSERT_EQ(follower->seen.size(), 2U);
    EXPECT_EQ(follower->seen[1], generation);
  }
}

TEST(AddRemove, TwoScenesAreIndependent) {
  SceneSpec spec = EmptyScene();
  spec.objects.push_back(BoxObject("cube", {0.4, 0, 0.5}));
  Scene a = Scene::Build(spec), b = Scene::Build(spec);
  a.AddObject(BoxObject("other", {0.6, 0, 0.5}));
  a.mutable_model()->opt.gravity[2] = 0;
  int calls = 0;
  a.AddResetHook([&](ResetContext&) { ++calls; });
  EXPECT_TRUE(a.StepN(50).ok());
  EXPECT_EQ(b.time(), 0);
  EXPECT_THAT(b.object_names(), ElementsAre("cube"));
  EXPECT_TRUE(b.StepN(50).ok());
  EXPECT_LT(b.body_pose("cube").translation().z(), 0.46);
  EXPECT_EQ(a.body_pose("cube").translation().z(), 0.5);
  b.Reset();
  EXPECT_EQ(calls, 0);
  a.Close();
  EXPECT_TRUE(b.Step().ok());
  EXPECT_THROW(a.AddObject(BoxObject("late", {})), ClosedError);
  EXPECT_THROW(a.RemoveObject("cube"), ClosedError);
}

}  // namespace
}  // namespace robocell
