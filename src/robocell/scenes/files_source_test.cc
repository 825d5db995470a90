#include "robocell/scenes/built_in_sources.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/pick_scene.h"

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

}  // namespace
}  // namespace robocell
