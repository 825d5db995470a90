#include "robocell/scene/source_files.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "robocell/scene/testing/scenes.h"

namespace robocell {
namespace {

// A scene with a mug, whose mesh has a file of its own.
class SourceFilesTest : public ::testing::Test {
 protected:
  SourceFilesTest() {
    Append("corner.obj",
           "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n");
    const std::string model = folder_.Write(
        "mug",
        "<asset><mesh name='corner' file='corner.obj'/></asset><worldbody><body name='mug'>"
        "<geom type='mesh' mesh='corner'/></body></worldbody>");
    spec_ = EmptyScene();
    spec_.objects.push_back({.name = "mug", .mjcf_path = model});
  }
  void Append(const std::string& file, const std::string& text) {
    std::ofstream(folder_.path() / file, std::ios::app) << text;
  }

  ModelFolder folder_;
  SceneSpec spec_;
};

TEST_F(SourceFilesTest, NothingDiffersUntilAFileIsChanged) {
  const SourceFiles before(spec_);
  EXPECT_EQ(before.Difference(SourceFiles(spec_)), "");
  Append("mug.xml", "<!-- changed -->");
  EXPECT_EQ(before.Difference(SourceFiles(spec_)), (folder_.path() / "mug.xml").string());
}

TEST_F(SourceFilesTest, FilesOfModelsCountToo) {
  const SourceFiles before(spec_);
  Append("corner.obj", "# changed\n");
  EXPECT_EQ(before.Difference(SourceFiles(spec_)), (folder_.path() / "corner.obj").string());
}

// Objects come and go: their files are of one of the two scenes.
TEST_F(SourceFilesTest, OnlyFilesOfBothAreCompared) {
  const SourceFiles with_mug(spec_);
  EXPECT_EQ(SourceFiles(EmptyScene()).Difference(with_mug), "");
  EXPECT_EQ(with_mug.Difference(SourceFiles(EmptyScene())), "");
}

TEST_F(SourceFilesTest, AMissingModelIsTheCompilersConcern) {
  const SourceFiles before(spec_);
  std::filesystem::remove(folder_.path() / "mug.xml");
  EXPECT_EQ(before.Difference(SourceFiles(spec_)), "");
}

}  // namespace
}  // namespace robocell
