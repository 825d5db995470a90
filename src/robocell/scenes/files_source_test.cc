#include "robocell/scenes/built_in_sources.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <filesystem>
#include <memory>
#include <string>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/scene/scene.h"
#include "robocell/scenes/scene_source.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/pick_scene.h"
#include "robocell/testing/source_dir.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(FilesSource, FindsFilesInTheirRoot) {
  RunConfig run = ExampleRun("demo.yaml");
  run.scenes = FilesScenes{.files = {"scenes/tabletop.xml", "cell_of_nobody.xml"},
                           .root = SourceDir() + "/models"};
  EXPECT_THAT(SceneIndices(run), ElementsAre(0, 1));
  EXPECT_THAT(*MakeBaseScene(run, 0).base, HasSubstr("models/scenes/tabletop.xml"));
  ExpectThrow<NotFoundError>([&] { MakeBaseScene(run, 1); }, "cell_of_nobody.xml");
  ExpectThrow<NotFoundError>([&] { MakeBaseScene(run, 2); },
                             "run 'demo': scenes: source 'files': no scene 2; it has 2 (0 ... 1)");
  ExpectThrow<NotFoundError>([&] { MakeBaseScene(run, -1); }, "no scene -1; it has 2 (0 ... 1)");
  ExpectThrow<NotFoundError>([&] { MakeSceneSource(run)->Make(5); },
                             "scene source 'files': no scene 5; it has 2 (0 ... 1)");
  ExpectThrow<NotFoundError>([] { MakeBaseScene(ExampleRun("demo.yaml"), -1); },
                             "no scene -1; it has any from 0 on");
}

// The engine's own reading of the file is the oracle.
TEST(FilesSource, ScenesAreTheFilesThatTheEngineReads) {
  RunConfig run = ExampleRun("demo.yaml");
  TempDir folder;
  AtomicWrite(folder / "two.xml",
              "<mujoco><worldbody><geom name='top' type='box' size='.3 .2 .1' pos='.1 0 .5'/>"
              "<body name='ball' pos='0 0 1'><freejoint/><geom type='sphere' size='.05'/></body>"
              "</worldbody></mujoco>");
  const std::string table = SourceDir() + "/models/scenes/tabletop.xml";
  const std::string two = (folder / "two.xml").string();
  run.scenes = FilesScenes{.files = {table, two}};
  for (int index = 0; index < 2; ++index) {
    const Scene scene = Scene::Build(MakeBaseScene(run, index));
    char error[500] = "";
    mjModel* read = mj_loadXML((index == 0 ? table : two).c_str(), nullptr, error, sizeof error);
    ASSERT_NE(read, nullptr) << error;
    const std::shared_ptr<mjModel> keep(read, &mj_deleteModel);
    for (int body = 1; body < read->nbody; ++body) {
      const char* name = mj_id2name(read, mjOBJ_BODY, body);
      const int same = mj_name2id(scene.model(), mjOBJ_BODY, name);
      ASSERT_GE(same, 0) << name;
      EXPECT_EQ(scene.model()->body_mass[same], read->body_mass[body]) << name;
    }
    EXPECT_EQ(scene.model()->ngeom, read->ngeom);
    EXPECT_EQ(scene.timestep(), run.rates.timestep().value()) << "the run's, not the file's";
  }
}

// Relative names count from the folder of the run file, unless `root` is another one.
TEST(FilesSource, RelativeFilesAreBesideTheRunFile) {
  TempDir folder;
  std::filesystem::create_directories(folder / "a");
  std::filesystem::create_directories(folder / "b");
  const auto write = [&](const std::string& in, const char* body) {
    AtomicWrite(folder / in / "lab.xml",
                "<mujoco><worldbody><body name='" + std::string(body) + "'/></worldbody></mujoco>");
  };
  write("a", "beside");
  write("b", "in_root");
  RunConfig run = ExampleRun("demo.yaml");
  run.source_dir = (folder / "a").string();
  const auto has = [&](const char* body) {
    return mj_name2id(Scene::Build(MakeBaseScene(run, 0)).model(), mjOBJ_BODY, body) >= 0;
  };
  run.scenes = FilesScenes{.files = {"lab.xml"}};
  EXPECT_TRUE(has("beside"));
  run.scenes = FilesScenes{.files = {"lab.xml"}, .root = (folder / "b").string()};
  EXPECT_TRUE(has("in_root"));
}

// One source, asked again after each change.
TEST(FilesSource, AnnotationsFollowTheirFileAndAllFilesOfTheModel) {
  TempDir folder;
  const auto write_bench = [&](double height) {
    AtomicWrite(folder / "bench.xml", "<mujoco><body name='bench' pos='0 0 " +
                                          std::to_string(height) +
                                          "'><geom type='box' size='.5 .5 .02'/></body></mujoco>");
  };
  write_bench(0.5);
  AtomicWrite(folder / "lab.xml",
              "<mujoco><worldbody><include file='bench.xml'/></worldbody></mujoco>");
  const auto write_words = [&](const std::string& word) {
    AtomicWrite(folder / "lab.annotations.yaml",
                "objects: [{object: bench, words: [" + word + "]}]");
  };
  write_words("the bench");
  RunConfig run = ExampleRun("demo.yaml");
  run.scenes = FilesScenes{.files = {(folder / "lab.xml").string()}};
  const std::shared_ptr<SceneSource> source = MakeSceneSource(run);
  const auto height = [&] {
    return source->CheckedAnnotations(0)->supports.at(0).face.frame_to_world.translation().z();
  };
  const auto words = [&] { return source->CheckedAnnotations(0)->objects.at(0).words; };
  EXPECT_NEAR(height(), 0.52, 1e-9);
  EXPECT_THAT(words(), ElementsAre("the bench"));
  write_bench(0.7);
  EXPECT_NEAR(height(), 0.72, 1e-9);
  write_words("the high bench");
  EXPECT_THAT(words(), ElementsAre("the high bench"));
}

}  // namespace
}  // namespace robocell
