#include "robocell/data/leftovers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "robocell/base/files.h"
#include "robocell/data/testing/sample_episode.h"
#include "robocell/data/verify.h"
#include "robocell/testing/long_form.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(RemoveLeftovers, RemovesFilesLinksAndFoldersOnly) {
  TempDir temp;
  AtomicWrite(temp / ".a.7.1.partial", "a file");
  fs::create_directory(temp / "elsewhere");
  fs::create_symlink(temp / "elsewhere", temp / ".b.7.1.partial");
  fs::create_directories(temp / "models/.rc7.7.2.partial/assets");
  fs::create_directory(temp / ".lock");
  EXPECT_THAT(RemoveLeftovers(temp.path()),
              ElementsAre(".a.7.1.partial", ".b.7.1.partial", "models/.rc7.7.2.partial"));
  EXPECT_TRUE(fs::exists(temp / "elsewhere"));
  EXPECT_TRUE(fs::exists(temp / ".lock"));
}

TEST(RemoveLeftovers, OfFoldersKeepsFilesAndFoldersInUse) {
  TempDir temp;
  AtomicWrite(temp / ".report-0-of-2.json.7.1.partial", "another shard may be writing it");
  fs::create_directory(temp / ".e0.7.1.partial");
  const SampleEpisode sample(0, false);
  const EpisodeWriter writer(temp.path(), "e1", sample.schema);
  EXPECT_THAT(RemoveLeftoverFolders(temp.path()), ElementsAre(".e0.7.1.partial"));
  EXPECT_EQ(UnfinishedIn(temp.path()).size(), 2u);
}

TEST(RemoveLeftovers, OfADeadWriterIncludeItsEpisodesAndModels) {
  TempDir temp;
  fs::create_directories(temp / "models/.rc7-0123.7.3.partial/content");
  fs::create_directories(temp / "models/.rc7-0123.8.3.partial/content");
  for (const char* name :
       {".e1.7.1.partial", ".e1_a03.7.2.partial", ".e2.7.1.partial", ".e1.8.1.partial"})
    fs::create_directory(temp / name);
  EXPECT_THAT(
      RemoveLeftovers(temp.path(), DeadWriter{"e1", 7}),
      ElementsAre(".e1.7.1.partial", ".e1_a03.7.2.partial", "models/.rc7-0123.7.3.partial"));
  EXPECT_THAT(UnfinishedIn(temp.path()),
              ElementsAre(".e1.8.1.partial", ".e2.7.1.partial", "models/.rc7-0123.8.3.partial"));
}

TEST(RemoveLeftovers, OfAPrefixKeepOtherPrefixesFilesAndFoldersInUse) {
  TempDir temp;
  const SampleEpisode sample(0, false);
  EpisodeWriter writer(temp.path(), "e-000004", sample.schema);
  fs::create_directories(temp / "models/.rc7-0123.7.3.partial/content");
  for (const char* name :
       {".e-000003.7.1.partial", ".e-000004.8.1.partial", ".e-left-000003.7.1.partial",
        ".ee-000003.7.1.partial", ".e000003.7.1.partial"})
    fs::create_directory(temp / name);
  AtomicWrite(temp / ".e-000005.7.1.partial", "a file");
  EXPECT_THAT(RemoveLeftoversOfNumbering(temp.path(), "e"),
              ElementsAre(".e-000003.7.1.partial", ".e-000004.8.1.partial",
                          "models/.rc7-0123.7.3.partial"));
  EXPECT_EQ(UnfinishedIn(temp.path()).size(), 5u);
  EXPECT_EQ(Verify(temp.path()).being_written.size(), 1u);
}

TEST(RemoveLeftovers, KeepsTheFolderOfALiveWriter) {
  TempDir temp;
  const SampleEpisode sample(0, false);
  EpisodeWriter writer(temp.path(), "e1", sample.schema);
  EXPECT_THAT(RemoveLeftovers(temp.path()), IsEmpty());
  EXPECT_THAT(RemoveLeftovers(temp.path(), DeadWriter{"e1", getpid()}), IsEmpty());
  EXPECT_EQ(Verify(temp.path()).being_written.size(), 1u);
}

// The lock of a work folder leaves no trace in the committed episode.
TEST(RemoveLeftovers, IgnoresCommittedEpisodes) {
  TempDir temp;
  SampleEpisode(0, false).Write(temp.path(), "e1");
  EXPECT_THAT(UnfinishedIn(temp.path()), IsEmpty());
  for (const auto& file : fs::directory_iterator(temp / "e1"))
    EXPECT_FALSE(file.path().filename().string().starts_with('.')) << file.path();
}

TEST(RemoveLeftovers, DetectsAWriterWithoutWriting) {
  TempDir temp;
  fs::create_directory(temp / ".e1.7.1.partial");
  EXPECT_FALSE(IsBeingWritten(temp / ".e1.7.1.partial"));
  EXPECT_TRUE(fs::is_empty(temp / ".e1.7.1.partial"));
  EXPECT_THAT(RemoveLeftovers(temp.path()), ElementsAre(".e1.7.1.partial"));
}

// A new folder is not locked for a moment: its writer notices its removal and takes another.
TEST(RemoveLeftovers, DoesNotDisturbStartingWriters) {
  TempDir temp;
  std::atomic<bool> done = false;
  std::thread sweeper([&] {
    while (!done) RemoveLeftovers(temp.path());
  });
  const SampleEpisode sample(0, false);
  const int episodes = LongForm() ? 50 : 15;
  for (int i = 0; i < episodes; ++i)
    EXPECT_NO_THROW(sample.Write(temp.path(), "e" + std::to_string(i)));
  done = true;
  sweeper.join();
  EXPECT_EQ(Verify(temp.path()).good.size(), static_cast<size_t>(episodes));
}

}  // namespace
}  // namespace robocell
