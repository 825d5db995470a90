#include "robocell/scene/compiled_scene.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <thread>

#include "robocell/base/error.h"
#include "robocell/mujoco/model_watch.h"
#include "robocell/scene/scene.h"
#include "robocell/scene/testing/scenes.h"
#include "robocell/scene/testing/workplace.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

TEST(CompiledScene, ServesOneSceneAtATimeUnlessFrozen) {
  const auto compiled = CompileScene(Workplace());
  std::optional<Scene> scene = Scene::FromCompiled(compiled);
  ExpectThrow<Error>([&] { Scene::FromCompiled(compiled); },
                     "scene 'test': its compiled scene is used by another scene already, and "
                     "changes of the model by one would affect the other. Freeze the compiled "
                     "scene to share it with Freeze (in Python freeze), or compile the spec again");
  scene->Close();
  scene = Scene::FromCompiled(compiled);
  scene.reset();
  scene = Scene::FromCompiled(compiled);
  compiled->Freeze();
  EXPECT_TRUE(Scene::FromCompiled(compiled).Step().ok());
}

TEST(CompiledScene, IsSharedBetweenScenesWhenFrozen) {
  const auto compiled = CompileScene(Workplace());
  compiled->Freeze();
  std::vector<std::vector<double>> ends(4);
  std::vector<std::thread> threads;
  for (auto& end : ends) {
    threads.emplace_back([&] {
      Scene scene = Scene::FromCompiled(compiled);
      EXPECT_TRUE(scene.StepN(200).ok());
      end = scene.state();
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const auto& end : ends) EXPECT_EQ(end, ends[0]);
  Scene scene = Scene::FromCompiled(compiled);
  ExpectThrow<Error>(
      [&] { scene.mutable_model(); },
      "scene 'test': its compiled scene is frozen because it is shared between scenes");
}

TEST(CompiledScene, HasANewGenerationEachTime) {
  const uint64_t first = CompileScene(Workplace())->generation();
  EXPECT_LT(first, CompileScene(Workplace())->generation());
}

TEST(CompiledScene, HandsItsModelOverOnce) {
  const auto compiled = CompileScene(Workplace());
  mjModel* model = compiled->mutable_model();
  int freed = 0;
  compiled->AdoptModelKeeper(std::shared_ptr<void>(model, [&](void* m) {
    mj_deleteModel(static_cast<mjModel*>(m));
    ++freed;
  }));
  EXPECT_TRUE(compiled->model_is_external());
  ExpectThrow<Error>([&] { compiled->AdoptModelKeeper(std::make_shared<int>(1)); },
                     "its model was handed over already");
  {
    Scene scene = Scene::FromCompiled(compiled);
    EXPECT_EQ(scene.model(), model);
    EXPECT_TRUE(scene.StepN(10).ok());
  }
  EXPECT_EQ(freed, 0);
}

// The model's keeper may free it at any time.
TEST(CompiledScene, NotifiesWatchersOfItsEndAfterTheHandOver) {
  auto compiled = CompileScene(Workplace());
  const std::shared_ptr<void> kept(compiled->mutable_model(),
                                   [](void* m) { mj_deleteModel(static_cast<mjModel*>(m)); });
  const ModelWatch watch(compiled->model());
  compiled->AdoptModelKeeper(kept);
  EXPECT_FALSE(watch.gone());
  compiled.reset();
  EXPECT_TRUE(watch.gone());
}

TEST(CompiledScene, AcceptsDataMadeElsewhere) {
  int freed = 0;
  {
    Scene scene = Scene::Build(Workplace(), [&](CompiledScene& compiled) {
      mjData* data = mj_makeData(compiled.model());
      return DataHandle{data, std::shared_ptr<void>(data, [&](void* d) {
                          mj_deleteData(static_cast<mjData*>(d));
                          ++freed;
                        })};
    });
    EXPECT_TRUE(scene.StepN(5).ok());
    EXPECT_EQ(scene.data_keeper().use_count(), 1);
  }
  EXPECT_EQ(freed, 1);
}

TEST(CompiledScene, ReportsEngineErrors) {
  ModelFolder folder;
  SceneSpec spec = EmptyScene();
  spec.objects.push_back(
      {.name = "ghost",
       .mjcf_path =
           folder.Write("ghost", R"(<worldbody><body name="g"><joint/></body></worldbody>)")});
  ExpectThrow<SpecError>([&] { Scene::Build(spec); },
                         "scene 'test' / object 'ghost': " + spec.objects[0].mjcf_path +
                             ":1: body 'g': mass and inertia of moving bodies must be larger than "
                             "mjMINVAL. A body that moves needs a mass: give one of its geoms a "
                             "`mass` or the body an <inertial>");
}

TEST(CompiledScene, AMissingObjectThatIsABodyOfOneIsNamed) {
  SceneSpec spec = EmptyScene();
  spec.objects.push_back({.name = "cupboard", .mjcf_path = "cabinet", .pos = Vec3{0, 0, 0}});
  const Scene scene = Scene::Build(spec);
  const auto message = [&](const std::string& name) {
    return ExpectThrow<NotFoundError>([&] { scene.compiled()->object(name); }, "no object '");
  };
  EXPECT_TRUE(
      message("cupboard_drawer").ends_with(" 'cupboard_drawer' is a body of object 'cupboard'"));
  EXPECT_TRUE(message("cupbord").ends_with("Did you mean 'cupboard'?"));
  EXPECT_TRUE(message("ubord_drawer").ends_with(" Object 'cupboard' has a body 'cupboard_drawer'"))
      << message("ubord_drawer");
}

}  // namespace
}  // namespace robocell
