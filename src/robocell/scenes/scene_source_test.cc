#include "robocell/scenes/scene_source.h"

#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/pick_scene.h"

namespace robocell {
namespace {

TEST(SceneSource, ATabletopUnlessFilesAreGiven) {
  const RunConfig run = ExampleRun("demo.yaml");
  const SceneSpec spec = MakeBaseScene(run, 0);
  EXPECT_EQ(spec.name, "demo");
  EXPECT_EQ(spec.base, "tabletop");
  EXPECT_EQ(spec.timestep, 0.002);
  EXPECT_TRUE(spec.robots.empty());
}

TEST(SceneSource, FilesAreFoundInTheirRoot) {
  RunConfig run = ExampleRun("demo.yaml");
  run.scenes = {.files = {"cell_of_nobody.xml"}, .root = SourceDir() + "/models"};
  ExpectThrow<NotFoundError>([&] { MakeBaseScene(run, 0); }, "cell_of_nobody.xml");
}

}  // namespace
}  // namespace robocell
