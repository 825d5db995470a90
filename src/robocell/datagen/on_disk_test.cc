#include "robocell/datagen/on_disk.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/data/episode_writer.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class OnDiskTest : public ::testing::Test {
 protected:
  OnDiskTest() {
    run.output = folder.path().string();
    run.max_attempts = 3;
  }
  void Write(const std::string& id, bool success) const {
    EpisodeSchema schema;
    const ColumnId time = schema.AddColumn({.name = "time"});
    EpisodeWriter writer(folder.path(), id, schema);
    writer.Put(time, 0.0);
    writer.EndRow();
    writer.Commit({.success = success});
  }

  TempDir folder;
  RunConfig run;
  const PlanItem item{.id = "e"};
};

TEST_F(OnDiskTest, ASuccessIsComplete) {
  EXPECT_FALSE(LookForItem(run, item).complete);
  Write("e", true);
  const ItemOnDisk found = LookForItem(run, item);
  EXPECT_TRUE(found.success && found.complete);
  EXPECT_TRUE(IsComplete(run, item));
}

TEST_F(OnDiskTest, AnEmptyFolderIsNeitherCountedNorInTheWay) {
  fs::create_directory(folder / "e");
  EXPECT_FALSE(IsComplete(run, item));
  EXPECT_THAT(LookForItem(run, item).broken, IsEmpty());
}

TEST_F(OnDiskTest, HalfAnEpisodeIsRefusedWithTheNextStep) {
  Write("e", true);
  fs::remove(folder / "e/episode.json");
  EXPECT_FALSE(LookForItem(run, item).success);
  EXPECT_THAT(LookForItem(run, item).broken, ElementsAre(HasSubstr("is half an episode")));
  ExpectThrow<IoError>([&] { IsComplete(run, item); },
                       "Set it aside: robocell verify --repair " + run.output);
  ExpectThrow<IoError>([&] { IsAttemptKept(run, item, 0); }, "is half an episode");
}

TEST_F(OnDiskTest, AFailureAmongSuccessesIsNamed) {
  Write("e", false);
  EXPECT_THAT(LookForItem(run, item).broken,
              ElementsAre(HasSubstr("is a failed episode in a dataset of successes")));
}

TEST_F(OnDiskTest, KeptFailuresAreCompleteWithTheLastAttempt) {
  run.keep = Keep::kAll;
  Write("e_a00", false);
  EXPECT_TRUE(IsAttemptKept(run, item, 0));
  EXPECT_FALSE(IsAttemptKept(run, item, 1));
  EXPECT_FALSE(IsComplete(run, item));
  Write("e_a02", false);
  EXPECT_TRUE(IsComplete(run, item));
  EXPECT_FALSE(LookForItem(run, item).success);
  Write("e_a01", true);
  EXPECT_TRUE(LookForItem(run, item).success);
}

TEST_F(OnDiskTest, APlanIsToldByItsItems) {
  Write("a", true);
  AtomicWrite(folder / "b", "in the way");
  const PlanOnDisk found = LookForItems(run, {{.id = "a"}, {.id = "b"}, {.id = "c"}});
  EXPECT_THAT(found.made, ElementsAre("a"));
  EXPECT_THAT(found.broken, ElementsAre(HasSubstr("move it away yourself")));
}

TEST_F(OnDiskTest, WhatIsBrokenDoesNotHideASuccess) {
  run.keep = Keep::kAll;
  Write("e_a01", true);
  fs::create_directory(folder / "e_a00");
  AtomicWrite(folder / "e_a00/episode.json", "{");
  EXPECT_TRUE(IsComplete(run, item));
}

}  // namespace
}  // namespace robocell
