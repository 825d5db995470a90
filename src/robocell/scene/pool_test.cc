// Tests the pool: objects that are added and removed without compiling.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/assets/resolve.h"
#include "robocell/base/error.h"
#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/scene_cache.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/ratio_of_times.h"

namespace robocell::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr const char* kJar = R"(
  <worldbody><body name="jar" pos="0 0 0.04"><freejoint/>
    <geom type="cylinder" size="0.03 0.04" mass="0.2" contype="3" conaffinity="5"/>
    <body name="lid" pos="0 0 0.05" gravcomp="0.5"><joint name="turn" axis="1 0 0" damping="0.001"/>
      <geom type="cylinder" size="0.03 0.005" mass="0.02"/>
      <geom type="sphere" size="0.01" pos="0 0 0.015" mass="0.01" contype="0" conaffinity="0"/></body>
  </body></worldbody>
  <actuator><position joint="turn" kp="0.1"/></actuator>
  <keyframe><key name="home" qpos="0 0 0 1 0 0 0 0.25"/></keyframe>)";

SceneObject Pooled(SceneObject object, bool parked = true) {
  object.parked = parked;
  return object;
}

// A robot, two objects outside the pool, and a pool of four.
class Pool : public ::testing::Test {
 protected:
  Pool() {
    spec = EmptyScene();
    spec.robots.push_back(
        {.config = RobotConfig::Load(assets::BuiltinRobotFile("rc7")), .prefix = "r_"});
    spec.objects = {
        BoxObject("table", {0.5, 0, 0.02}),
        Pooled(BoxObject("a", {0.5, 0.2, 0.02})),
        Pooled(BoxObject("b", {0.5, -0.2, 0.1}), false),
        Pooled({.name = "jar",
                .mjcf_path = folder.Write("jar", kJar),
                .attach_to = {AttachKind::kRoot},
                .pos = Vec3{0.8, 0.1, 0},
                .euler = {0, 0, 30}}),
        BoxObject("cube", {0.5, 0, 0.08}),
        Pooled({.name = "mug", .mjcf_path = "mug", .pos = Vec3{0.6, 0.3, 0}, .fixed = false})};
    spec.root_frame_to_world = Pose::FromRpy({0.1, 0.2, 0}, {0, 0, 0.3});
  }
  // Closes a scene that changed the pool.
  void UseAndClose(const std::shared_ptr<CompiledScene>& compiled) {
    Scene scene = Scene::FromCompiled(compiled);
    scene.AddObject("a");
    scene.AddObject("jar");
    scene.RemoveObject("b");
    scene.Close();
  }
  ModelFolder folder;
  SceneSpec spec;
};

int Address(const Scene& scene, const std::string& joint) {
  return scene.model()->jnt_qposadr[RequireId(scene.model(), mjOBJ_JOINT, joint, "")];
}

std::vector<double> Masks(const Scene& scene, const std::string& body) {
  const mjModel* m = scene.model();
  const int b = RequireId(m, mjOBJ_BODY, body, ""), g = m->body_geomadr[b];
  return {static_cast<double>(m->geom_contype[g]), static_cast<double>(m->geom_conaffinity[g]),
          static_cast<double>(m->body_contype[b]), static_cast<double>(m->body_conaffinity[b]),
          m->body_gravcomp[b]};
}

TEST_F(Pool, StartsFromTheSpecAndChangesByName) {
  Scene scene = Scene::Build(spec);
  EXPECT_THAT(scene.object_names(), ElementsAre("table", "b", "cube"));
  EXPECT_THAT(scene.parked_objects(), ElementsAre("a", "jar", "mug"));
  EXPECT_THAT(Masks(scene, "a"), ElementsAre(0, 0, 0, 0, 1));
  const mjModel* model = scene.model();
  const mjData* data = scene.data();
  const uint64_t generation = scene.generation();
  scene.AddObject("a");
  EXPECT_THAT(Masks(scene, "a"), ElementsAre(1, 1, 1, 1, 0));
  EXPECT_TRUE(scene.body_pose("a").is_close(Pose(Eigen::Vector3d(0.5, 0.2, 0.02)), 0, 0));
  scene.AddObject("jar", Pose(Eigen::Vector3d(0.7, -0.1, 0.04)));
  EXPECT_THAT(Masks(scene, "jar_jar"), ElementsAre(3, 5, 3, 5, 0));
  EXPECT_THAT(Masks(scene, "jar_lid"), ElementsAre(1, 1, 1, 1, 0.5));
  EXPECT_EQ(scene.data()->qpos[Address(scene, "jar_turn")], 0.25);
  EXPECT_THAT(scene.object_names(), ElementsAre("table", "a", "b", "jar", "cube"));
  EXPECT_TRUE(scene.StepN(300).ok());
  EXPECT_THAT(scene.contacts("a"), ::testing::SizeIs(4));
  EXPECT_NEAR(scene.body_pose("jar_jar").translation().z(), 0.04, 2e-3);
  scene.RemoveObject("a");
  EXPECT_THAT(scene.contacts("a"), IsEmpty());
  EXPECT_GT(scene.body_pose("a").translation().z(), 900);
  EXPECT_EQ(scene.model(), model);
  EXPECT_EQ(scene.data(), data);
  EXPECT_EQ(scene.generation(), generation);
}

// Measured at one each; compiling anew takes dozens.
TEST_F(Pool, AddingOrRemovingTakesAFewForwards) {
  Scene scene = Scene::Build(spec);
  const auto comes_and_goes = [&] {
    for (int i = 0; i < 10; ++i) {
      scene.AddObject("a");
      scene.RemoveObject("a");
    }
  };
  const auto forwards = [&] {
    for (int i = 0; i < 20; ++i) scene.Forward();
  };
  EXPECT_LT(RatioOfTimes(comes_and_goes, forwards), Allowed(8));
}

// The same object with another pose: the result equals a scene that was built so.
TEST_F(Pool, ASpecWithAnotherPoseMovesTheObject) {
  Scene scene = Scene::Build(spec);
  SceneObject jar = spec.objects[3];
  scene.AddObject(jar);
  const Pose declared = scene.body_pose("jar_jar");
  scene.RemoveObject("jar");
  jar.pos = {0.2, 0.5, 0.3};
  jar.euler = {0, 90, 10};
  jar.attach_to = {AttachKind::kWorld};
  scene.AddObject(jar);
  SceneSpec other = spec;
  other.objects[3] = jar;
  other.objects[3].parked = false;
  const Scene built = Scene::Build(other);
  EXPECT_TRUE(scene.body_pose("jar_jar").is_close(built.body_pose("jar_jar"), 1e-12, 1e-12));
  EXPECT_FALSE(scene.body_pose("jar_jar").is_close(declared, 0.1, 0.1));
}

TEST_F(Pool, RemovingAndAddingRestoresStateAndModelBitwise) {
  Scene scene = Scene::Build(spec);
  for (int round = 0; round < 5; ++round) {
    EXPECT_TRUE(scene.StepN(30).ok());
    const std::vector<double> state = scene.state();
    const std::string model = SaveBinaryString(scene.model());
    for (const char* name : {"jar", "mug", "a"}) scene.AddObject(name);
    for (const char* name : {"a", "jar", "mug"}) scene.RemoveObject(name);
    // A parked object is exactly at its place; before, it was there up to rounding.
    const std::vector<double> again = scene.state();
    ASSERT_EQ(again.size(), state.size());
    for (size_t i = 0; i < state.size(); ++i) EXPECT_NEAR(again[i], state[i], 1e-9) << i;
    EXPECT_TRUE(SaveBinaryString(scene.model()) == model);
    for (const char* name : {"jar", "mug", "a"}) scene.AddObject(name);
    for (const char* name : {"a", "jar", "mug"}) scene.RemoveObject(name);
    EXPECT_TRUE(scene.state() == again);
  }
}

TEST_F(Pool, ParkedObjectsRestAndMoveNothing) {
  SceneSpec without = spec;
  std::erase_if(without.objects.boxes(), [](const auto& o) { return o->parked == true; });
  Scene scene = Scene::Build(spec), bare = Scene::Build(without);
  EXPECT_TRUE(scene.StepN(50).ok());
  EXPECT_TRUE(bare.StepN(50).ok());
  for (const std::string& body : bare.body_names())
    EXPECT_TRUE(scene.body_pose(body).is_close(bare.body_pose(body), 1e-9, 1e-9)) << body;
  const Pose a = scene.body_pose("a"), lid = scene.body_pose("jar_lid");
  EXPECT_TRUE(scene.StepN(5000).ok());
  EXPECT_TRUE(scene.body_pose("a").is_close(a, 1e-6, 1e-6));
  EXPECT_TRUE(scene.body_pose("jar_lid").is_close(lid, 1e-6, 1e-3));
  EXPECT_NEAR(scene.body_pose("table").translation().z(), 0.02, 1e-3);
}

// The history of an object in the scene has no effect when it returns, or on the other objects.
TEST_F(Pool, ATrajectoryAfterAResetIsIndependentOfThePast) {
  Scene lived = Scene::Build(spec), fresh = Scene::Build(spec);
  lived.AddObject("a");
  lived.AddObject("jar");
  lived.RemoveObject("b");
  lived.data()->xfrc_applied[6] = 3;
  EXPECT_TRUE(lived.StepN(100).ok());
  const auto run = [](Scene& scene, const ResetOptions& options) {
    scene.Reset(options);
    std::vector<double> states = scene.state();
    scene.AddObject("a");
    EXPECT_TRUE(scene.StepN(200).ok());
    scene.RemoveObject("b");
    EXPECT_TRUE(scene.StepN(50).ok());
    for (const double number : scene.state()) states.push_back(number);
    return states;
  };
  EXPECT_TRUE(run(lived, {.seed = 3}) == run(fresh, {.seed = 3}));
  EXPECT_TRUE(SaveBinaryString(lived.model()) == SaveBinaryString(fresh.model()));
  lived.Reset();
  EXPECT_THAT(lived.parked_objects(), ElementsAre("a", "jar", "mug"));
  EXPECT_TRUE(run(lived, {.use_keyframe = false}) == run(fresh, {.use_keyframe = false}));
}

TEST_F(Pool, AHookChoosesTheObjectsInTheScene) {
  Scene scene = Scene::Build(spec);
  scene.AddResetHook([](ResetContext& reset) {
    reset.scene.AddObject("mug", Pose(Eigen::Vector3d(0.4, 0.3, 0.05)));
  });
  for (int i = 0; i < 3; ++i) {
    scene.Reset();
    EXPECT_THAT(scene.parked_objects(), ElementsAre("a", "jar"));
    EXPECT_EQ(scene.body_pose("mug_mug").translation().x(), 0.4);
    EXPECT_TRUE(scene.StepN(20).ok());
  }
}

// A state contains the set of active objects.
TEST_F(Pool, StatesRestoreTheirObjects) {
  Scene scene = Scene::Build(spec);
  const std::vector<double> before = scene.state();
  scene.AddObject("a");
  scene.RemoveObject("b");
  EXPECT_TRUE(scene.StepN(10).ok());
  const std::vector<double> there = scene.state();
  EXPECT_TRUE(scene.StepN(50).ok());
  const std::vector<double> later = scene.state();
  scene.SetState(before);
  EXPECT_THAT(scene.parked_objects(), ElementsAre("a", "jar", "mug"));
  EXPECT_THAT(Masks(scene, "a"), ElementsAre(0, 0, 0, 0, 1));
  scene.SetState(there);
  EXPECT_THAT(scene.parked_objects(), ElementsAre("b", "jar", "mug"));
  EXPECT_TRUE(scene.StepN(50).ok());
  EXPECT_TRUE(scene.state() == later);
}

TEST_F(Pool, StaysWhenTheSceneIsRecompiled) {
  Scene scene = Scene::Build(spec);
  scene.AddObject("jar");
  scene.RemoveObject("b");
  EXPECT_TRUE(scene.StepN(20).ok());
  const std::vector<double> state = scene.state();
  const std::string model = SaveBinaryString(scene.model());
  scene.AddObject(BoxObject("late", {1, 1, 0.02}));
  EXPECT_THAT(scene.parked_objects(), ElementsAre("a", "b", "mug"));
  EXPECT_THAT(Masks(scene, "b"), ElementsAre(0, 0, 0, 0, 1));
  EXPECT_THAT(Masks(scene, "jar_jar"), ElementsAre(3, 5, 3, 5, 0));
  scene.RemoveObject("late");
  EXPECT_TRUE(scene.state() == state);
  EXPECT_TRUE(SaveBinaryString(scene.model()) == model);
  scene.Reset();
  EXPECT_THAT(scene.parked_objects(), ElementsAre("a", "jar", "mug"));
}

TEST_F(Pool, SavedXmlOmitsParkedObjectsAndBinaryKeepsThem) {
  Scene scene = Scene::Build(spec);
  scene.AddObject("jar");
  scene.mutable_model()->geom_friction[0] = 0.125;
  const ModelPtr loaded = Compile(ParseXmlString(scene.ToXml()).get());
  const auto id = [&](const char* body) { return FindId(loaded.get(), mjOBJ_BODY, body); };
  EXPECT_LT(id("a"), 0);
  EXPECT_LT(id("mug_mug"), 0);
  EXPECT_GE(id("b"), 0);
  EXPECT_GE(id("cube"), 0);
  EXPECT_EQ(loaded->geom_contype[loaded->body_geomadr[id("jar_jar")]], 3);
  EXPECT_EQ(loaded->body_gravcomp[id("jar_lid")], 0.5);
  EXPECT_EQ(loaded->geom_friction[0], 0.125);
  const int joint = loaded->body_jntadr[id("jar_jar")];
  EXPECT_LT(loaded->key_qpos[loaded->jnt_qposadr[joint] + 2], 1);
  const std::string file = (folder.path() / "scene.mjb").string();
  scene.SaveBinary(file);
  EXPECT_EQ(LoadBinary(file)->nbody, scene.model()->nbody);
}

TEST_F(Pool, IsRestoredFromTheCache) {
  const auto first = CompileSceneCached(spec, folder.path());
  Scene scene = Scene::FromCompiled(CompileSceneCached(spec, folder.path()));
  EXPECT_THAT(scene.parked_objects(), ElementsAre("a", "jar", "mug"));
  scene.AddObject("jar");
  EXPECT_THAT(Masks(scene, "jar_jar"), ElementsAre(3, 5, 3, 5, 0));
  Scene other = Scene::FromCompiled(first);
  other.AddObject("jar");
  EXPECT_TRUE(other.state() == scene.state());
}

TEST_F(Pool, RejectsStartPosesOfObjectsThatAResetParks) {
  Scene scene = Scene::Build(spec);
  const auto start = [&] { scene.Reset({.body_poses = {{"a", Pose()}}}); };
  const char* refused =
      "scene 'test': a reset parks object 'a', so it cannot start anywhere; put it into the scene "
      "after the reset, at its pose, with AddObject (in Python add_object)";
  ExpectThrow<ArgumentError>(start, refused);
  scene.AddObject("a");
  const std::vector<double> state = scene.state();
  ExpectThrow<ArgumentError>(start, refused);
  EXPECT_TRUE(scene.state() == state);
}

TEST_F(Pool, RejectedChangesLeaveTheSceneAlone) {
  Scene scene = Scene::Build(spec);
  const std::vector<double> state = scene.state();
  ExpectThrow<ArgumentError>([&] { scene.AddObject("b"); },
                             "scene 'test': object 'b' is in the scene already; move it with "
                             "SetBodyPose (in Python set_body_pose), or remove it first");
  ExpectThrow<NotFoundError>(
      [&] { scene.AddObject("mugg"); },
      "scene 'test' / pool: no object 'mugg'. Its objects: a, jar, mug. Did "
      "you mean 'mug'? Declare it with `parked` in the scene's spec, or give "
      "a SceneObject");
  ExpectThrow<NotFoundError>([&] { scene.RemoveObject("a"); },
                             "scene 'test': object 'a' is parked, not in the scene. Objects in it: "
                             "table, b, cube");
  ExpectThrow<ArgumentError>(
      [&] { scene.SetBodyPose("a", Pose()); },
      "scene 'test': object 'a' is parked, so it cannot be moved; "
      "put it into the scene at its pose with AddObject (in Python add_object)");
  SceneObject heavy = spec.objects[1];
  heavy.mass = 5;
  ExpectThrow<ArgumentError>([&] { scene.AddObject(heavy); },
                             "scene 'test': the pool has another object 'a'; only its pose may "
                             "differ from the spec's. Give the new one another name");
  SceneObject hung = spec.objects[1];
  hung.attach_to = {AttachKind::kBody, "r_link7"};
  ExpectThrow<ArgumentError>([&] { scene.AddObject(hung); },
                             "scene 'test': object 'a' can move freely, so it cannot be attached");
  EXPECT_TRUE(scene.state() == state);
  SceneSpec wrong = spec;
  wrong.objects[1].fixed = true;
  ExpectThrow<SpecError>([&] { Scene::Build(wrong); },
                         "object 'a': parked: only what can move freely comes and goes without "
                         "compiling; set fixed: false, or leave parked unset");
}

TEST_F(Pool, OfAFrozenModelCannotChange) {
  const auto compiled = CompileScene(spec);
  compiled->Freeze();
  Scene scene = Scene::FromCompiled(compiled), other = Scene::FromCompiled(compiled);
  EXPECT_THAT(scene.object_names(), ElementsAre("table", "b", "cube"));
  ExpectThrow<Error>([&] { scene.AddObject("a"); },
                     "object 'a' cannot be added: the compiled scene is frozen");
  ExpectThrow<Error>([&] { scene.RemoveObject("b"); },
                     "object 'b' cannot be removed: the compiled scene is frozen");
  scene.Reset();
  EXPECT_TRUE(scene.StepN(10).ok());
  other.SetState(scene.state());
  Scene own = Scene::Build(spec);
  own.AddObject("a");
  const std::vector<double> before = other.state();
  ExpectThrow<Error>([&] { other.SetState(own.state()); },
                     "object 'a' cannot be added by this state: the compiled scene is frozen");
  EXPECT_TRUE(other.state() == before);
}

// Returns masks and weight of the whole pool, and its positions after half a second.
std::vector<double> PoolAndFall(Scene& scene) {
  std::vector<double> out;
  for (const char* body : {"a", "b", "jar_jar", "jar_lid"}) {
    for (const double value : Masks(scene, body)) out.push_back(value);
  }
  EXPECT_TRUE(scene.StepN(250).ok());
  const std::vector<double> state = scene.state();
  out.insert(out.end(), state.begin(), state.end());
  out.push_back(scene.model()->ngravcomp);
  return out;
}

TEST_F(Pool, IsFreshForEachSceneOnAModel) {
  Scene fresh = Scene::Build(spec);
  const std::vector<double> as_new = PoolAndFall(fresh);
  const auto compiled = CompileScene(spec);
  UseAndClose(compiled);
  Scene next = Scene::FromCompiled(compiled);
  EXPECT_EQ(next.object_names(), fresh.object_names());
  EXPECT_EQ(PoolAndFall(next), as_new);
  next.Close();
  UseAndClose(compiled);
  Scene copy = Scene::FromCompiled(compiled->Copy());
  EXPECT_EQ(PoolAndFall(copy), as_new);
  compiled->Freeze();
  Scene frozen = Scene::FromCompiled(compiled);
  EXPECT_EQ(frozen.object_names(), fresh.object_names());
  EXPECT_EQ(PoolAndFall(frozen), as_new);
}

TEST_F(Pool, RejectsFreezingAChangedPool) {
  const auto compiled = CompileScene(spec);
  Scene scene = Scene::FromCompiled(compiled);
  scene.AddObject("a");
  scene.RemoveObject("b");
  ExpectThrow<Error>(
      [&] { compiled->Freeze(); },
      "scene 'test': its compiled scene cannot be frozen as its present scene has it, as other "
      "scenes would begin so: object 'a' was added, object 'b' was removed. Reset that scene and "
      "switch the modes back, or close it; or freeze before");
  EXPECT_FALSE(compiled->frozen());
  scene.RemoveObject("a");
  scene.Reset();
  compiled->Freeze();
  scene.Reset();
  EXPECT_THAT(scene.object_names(), ElementsAre("table", "b", "cube"));
}

TEST_F(Pool, KeepsUserEditsOfTheModel) {
  const auto compiled = CompileScene(spec);
  Scene first = Scene::FromCompiled(compiled);
  const int b = RequireId(first.model(), mjOBJ_BODY, "b", "");
  first.mutable_model()->body_mass[b] = 3;
  first.mutable_model()->geom_contype[first.model()->body_geomadr[b]] = 2;
  first.Close();
  const Scene next = Scene::FromCompiled(compiled);
  EXPECT_EQ(next.model()->body_mass[b], 3);
  EXPECT_EQ(next.model()->geom_contype[next.model()->body_geomadr[b]], 2);
}

TEST_F(Pool, RestoresTheControlsOfItsActuators) {
  spec.objects = {Pooled({.name = "o", .mjcf_path = folder.Write("o", R"(
    <worldbody><body><freejoint/><geom size="0.05" mass="1"/><site name="hook" pos="0 0 0.1"/>
      <site name="crank" pos="0.1 0 0" euler="0 90 0"/>
      <body pos="0.2 0 0"><joint name="s" type="slide" axis="1 0 0"/><geom size="0.02" mass="0.1"/>
        <site name="rod"/></body>
    </body></worldbody>
    <tendon><fixed name="coupled"><joint joint="s" coef="1"/></fixed>
      <spatial name="rope"><site site="hook"/><site site="rod"/></spatial></tendon>
    <actuator><position joint="s" kp="10"/><position tendon="coupled" kp="10"/>
      <motor tendon="rope"/><motor site="rod" gear="0 0 1"/>
      <motor cranksite="rod" slidersite="crank" cranklength="0.3"/></actuator>)")},
                         false)};
  spec.robots = {};
  Scene scene = Scene::Build(spec);
  for (int i = 0; i < scene.model()->nu; ++i) scene.data()->ctrl[i] = 0.5;
  scene.RemoveObject("o");
  scene.AddObject("o");
  for (int i = 0; i < scene.model()->nu; ++i) EXPECT_EQ(scene.data()->ctrl[i], 0) << i;
}

}  // namespace
}  // namespace robocell::internal
