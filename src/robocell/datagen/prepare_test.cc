#include "robocell/datagen/prepare.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/data/dataset.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

RunConfig Demo(const std::filesystem::path& output) {
  RunConfig run = RunConfig::Load(std::string(ROBOCELL_SOURCE_DIR) + "/examples/demo.yaml");
  run.output = output.string();
  return run;
}

TEST(PrepareDataset, CreatesTheFolderWithItsManifest) {
  TempDir folder;
  const RunConfig run = Demo(folder / "a/b");
  PrepareDataset(run);
  const auto manifest = nlohmann::json::parse(ReadManifest(folder / "a/b").value());
  EXPECT_EQ(manifest["run"], "demo");
  EXPECT_THAT(manifest["identity"].get<std::string>(), HasSubstr("base_distance: [0.3, 0.55]"));
  EXPECT_EQ(Dataset(folder / "a/b").size(), 0u);
}

TEST(PrepareDataset, IsTheSameManifestWhoeverMakesIt) {
  TempDir folder;
  RunConfig run = Demo(folder / "a");
  PrepareDataset(run);
  run.output = (folder / "b").string();
  run.workers = 7;
  PrepareDataset(run);
  EXPECT_EQ(ReadManifest(folder / "a"), ReadManifest(folder / "b"));
}

TEST(PrepareDataset, GoesOnWithMoreEpisodesAndOtherWorkers) {
  TempDir folder;
  RunConfig run = Demo(folder / "out");
  PrepareDataset(run);
  run.workers = 5;
  run.episodes = 3;
  run.episodes_per_scene = 50;
  EXPECT_NO_THROW(PrepareDataset(run));
}

TEST(PrepareDataset, RefusesAnotherConfigurationAndShowsTheLines) {
  TempDir folder;
  RunConfig run = Demo(folder / "out");
  PrepareDataset(run);
  run.task.base_distance = {0.2, 0.5};
  const std::string text =
      ExpectThrow<SpecError>([&] { PrepareDataset(run); }, "was begun with another configuration");
  EXPECT_THAT(text, HasSubstr("-   base_distance: [0.3, 0.55]\n"));
  EXPECT_THAT(text, HasSubstr("+   base_distance: [0.2, 0.5]\n"));
  EXPECT_THAT(text, HasSubstr(run.output));
  EXPECT_THAT(text, Not(HasSubstr("base_height")));
}

TEST(PrepareDataset, LeavesOtherFoldersAlone) {
  TempDir folder;
  AtomicWrite(folder / "thesis.txt", "years of work");
  ExpectThrow<SpecError>([&] { PrepareDataset(Demo(folder.path())); },
                         "holds 'thesis.txt' and is no dataset");
  EXPECT_FALSE(ReadManifest(folder.path()));
}

// What an interrupted process leaves is no reason to stop.
TEST(PrepareDataset, OverlooksUnfinishedWrites) {
  TempDir folder;
  MakeTempDirectory(folder.path(), "s0000_e0000");
  EXPECT_NO_THROW(PrepareDataset(Demo(folder.path())));
}

TEST(PrepareDataset, SaysWhichFolderCannotBeWritten) {
  TempDir folder;
  AtomicWrite(folder / "file", "");
  const RunConfig run = Demo(folder / "file/out");
  const std::string text =
      ExpectThrow<IoError>([&] { PrepareDataset(run); }, "cannot create the dataset's folder");
  EXPECT_THAT(text, HasSubstr(run.output));
}

TEST(PrepareDataset, AsksForAnOutput) {
  ExpectThrow<SpecError>([] { PrepareDataset(Demo("")); }, "output: where should the dataset go?");
}

TEST(PrepareDataset, NamesADamagedManifest) {
  TempDir folder;
  const RunConfig run = Demo(folder.path());
  PrepareDataset(run);
  AtomicWrite(folder / "dataset.json", "{\"format\": ");
  ExpectThrow<IoError>([&] { PrepareDataset(run); }, "dataset.json' is damaged");
}

TEST(DifferingLines, AreWhatIsNotInBothTexts) {
  EXPECT_THAT(DifferingLines("a\nb\nc\n", "a\nb\nc\n"), IsEmpty());
  EXPECT_THAT(DifferingLines("a\nb\nc\n", "a\nx\nc\ny\n"), ElementsAre("- b", "+ x", "+ y"));
  EXPECT_THAT(DifferingLines("", "a"), ElementsAre("+ a"));
  EXPECT_THAT(DifferingLines("a\nb", ""), ElementsAre("- a", "- b"));
}

}  // namespace
}  // namespace robocell
