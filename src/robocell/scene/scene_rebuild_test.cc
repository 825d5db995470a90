// Tests objects that are added and removed while a scene runs: new state, state kept to the bit,
// rejections.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "robocell/base/error.h"
#include "robocell/base/rng.h"
#include "robocell/mujoco/compile.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/random_scenes.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/scene/testing/workplace.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(AddRemove, AnObjectIsAddedAndRemovedInARunningScene) {
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

TEST(AddRemove, AddingThenRemovingRestoresStateAndModel) {
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
  // To the bit equal to a scene that was built so.
  Scene fresh = Scene::Build(scene.spec());
  fresh.AddResetHook([](ResetContext& reset) {
    reset.scene.SetBodyPose("cube", Pose(Eigen::Vector3d(0.2, 0, 0.1)));
  });
  fresh.Reset();
  EXPECT_TRUE(scene.StepN(200).ok());
  EXPECT_TRUE(fresh.StepN(200).ok());
  EXPECT_TRUE(scene.state() == fresh.state());
}

TEST(AddRemove, AHookCanAddObjects) {
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

// Nothing in a scene differs after `change` has thrown.
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

TEST(AddRemove, RejectedChangesLeaveTheSceneAlone) {
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

// Names do not show the owner of a frame: `cup_big_handle` could belong to `cup` as well.
TEST(AddRemove, AnObjectOnAFrameOfAnotherDoesNotBlockRemoval) {
  ModelFolder folder;
  const std::string cup = folder.Write("cup", R"(<worldbody><body name="cup">
      <geom size="0.05"/><frame name="big_lid" pos="0 0 0.1"><site/></frame></body></worldbody>)");
  const std::string big = folder.Write("big", R"(<worldbody><body name="cup"><geom size="0.1"/>
      <body name="side" pos="0.1 0 0"><geom size="0.02"/>
      <frame name="handle" pos="0.1 0 0"><site/></frame></body></body></worldbody>)");
  SceneSpec spec = EmptyScene();
  spec.objects = {{.name = "cup", .mjcf_path = cup, .pos = Vec3{1, 0, 0}},
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

// Objects are added by compiling the spec again, and its files may have changed by then.
TEST(AddRemove, ReportsAChangedFileAndKeepsTheScene) {
  ModelFolder folder;
  const auto cup = [](const char* mass) {
    return fmt::format(R"(<worldbody><body name="b"><freejoint/><geom size="0.1" mass="{}"/></body>
                       </worldbody>)",
                       mass);
  };
  SceneSpec spec = EmptyScene();
  const std::string file = folder.Write("cup", cup("1"));
  spec.objects = {{.name = "cup", .mjcf_path = file, .pos = Vec3{0, 0, 1}},
                  BoxObject("cube", {1, 0, 0.02})};
  Scene scene = Scene::Build(spec);
  const mjModel* model = scene.model();
  const std::string bytes = SaveBinaryString(model);
  folder.Write("cup", cup("1.25"));
  const std::string changed =
      "scene 'test': '" + file +
      "' has changed since the scene was compiled, and objects are added and removed by compiling "
      "it again, which would change the present ones too. Build a new scene, or restore the file";
  ExpectThrow<Error>([&] { scene.AddObject(BoxObject("late", {1, 1, 0.02})); }, changed);
  ExpectThrow<Error>([&] { scene.RemoveObject("cube"); }, changed);
  EXPECT_EQ(scene.model(), model);
  EXPECT_TRUE(SaveBinaryString(scene.model()) == bytes);
  EXPECT_THAT(scene.object_names(), ElementsAre("cup", "cube"));
  scene.RemoveObject("cup");  // needs no file of it
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
            "is shared between scenes. Build a separate scene with Scene::Build (in Python "
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

TEST(AddRemove, NotifiesEveryObserverOfAnUndoneChange) {
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
