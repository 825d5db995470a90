#include "robocell/rollout/on_disk.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/data/dataset.h"
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
  // Writes an episode of the run, after attempts that were refused or failed.
  void Write(const std::string& id, bool success, const EarlierAttempts& earlier = {}) const {
    WriteOf(run, id, success, {{kEarlierAttempts, nlohmann::json::parse(ToJson(earlier))}});
  }
  void WriteOf(const RunConfig& origin, const std::string& id, bool success,
               nlohmann::json metadata = {}, const std::string& mujoco = mj_versionString()) const {
    EpisodeSchema schema;
    const ColumnId time = schema.AddColumn({.name = "time"});
    metadata["identity"] = RunIdentity(origin);
    EpisodeWriter writer(folder.path(), id, schema,
                         {.metadata_json = metadata.dump(),
                          .versions_json = nlohmann::json{{"mujoco", mujoco}}.dump()});
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

TEST_F(OnDiskTest, IgnoresAnEmptyFolder) {
  fs::create_directory(folder / "e");
  EXPECT_FALSE(IsComplete(run, item));
  EXPECT_THAT(LookForItem(run, item).broken, IsEmpty());
}

TEST_F(OnDiskTest, RejectsAnIncompleteEpisodeWithTheNextStep) {
  Write("e", true);
  fs::remove(folder / "e/episode.json");
  EXPECT_FALSE(LookForItem(run, item).success);
  EXPECT_THAT(LookForItem(run, item).broken, ElementsAre(HasSubstr("is half an episode")));
  ExpectThrow<IoError>([&] { IsComplete(run, item); },
                       "Set it aside: robocell verify --repair " + run.output);
  ExpectThrow<IoError>([&] { KeptAttempt(run, item, 0); }, "is half an episode");
}

TEST_F(OnDiskTest, AFailureAmongSuccessesIsNamed) {
  Write("e", false);
  EXPECT_THAT(LookForItem(run, item).broken,
              ElementsAre(HasSubstr("is a failed episode in a dataset of successes")));
}

TEST_F(OnDiskTest, KeptFailuresAreCompleteWithTheLastRollout) {
  run.keep = Keep::kAll;
  Write("e_a00", false);
  EXPECT_TRUE(KeptAttempt(run, item, 0));
  EXPECT_FALSE(KeptAttempt(run, item, 1));
  EXPECT_FALSE(IsComplete(run, item));
  Write("e_a02", false);
  EXPECT_FALSE(IsComplete(run, item)) << "attempt 1 is missing";
  Write("e_a01", false);
  EXPECT_TRUE(IsComplete(run, item));
  EXPECT_FALSE(LookForItem(run, item).success);
}

// For example one that repair moved away.
TEST_F(OnDiskTest, AMissingFailureBeforeTheSuccessIsRepeated) {
  run.keep = Keep::kAll;
  Write("e_a02", true,
        {{.object_kind = "mug", .reason = "dropped"},
         {.object_kind = "mug", .refused = true, .reason = "too far"}});
  EXPECT_TRUE(LookForItem(run, item).success);
  EXPECT_FALSE(IsComplete(run, item));
  EXPECT_THAT(LookForItems(run, {item}).made, IsEmpty());
  Write("e_a00", false);
  EXPECT_TRUE(IsComplete(run, item)) << "attempt 1 was refused and left nothing";
  EXPECT_THAT(LookForItems(run, {item}).made, ElementsAre("e"));
}

// An attempt in which a user's code raised leaves no episode: nothing is missing without one.
TEST_F(OnDiskTest, AnAttemptThatRaisedIsNotMissing) {
  run.keep = Keep::kAll;
  const EarlierAttempts earlier = {{.raised = true, .reason = "mine.py:3, in act: no"},
                                   {.object_kind = "mug", .reason = "dropped"}};
  Write("e_a02", true, earlier);
  EXPECT_FALSE(IsComplete(run, item)) << "the failure of attempt 1 is missing";
  Write("e_a01", false, {earlier.front()});
  EXPECT_TRUE(IsComplete(run, item));
  EXPECT_THAT(LookForItems(run, {item}).made, ElementsAre("e"));
  const std::string metadata = Dataset(run.output).Open("e_a02").metadata_json();
  const EarlierAttempts read = EarlierAttemptsIn(metadata);
  ASSERT_EQ(read.size(), 2u);
  EXPECT_TRUE(read[0].raised && read[0].left_nothing() && !read[0].refused);
  EXPECT_EQ(read[0].reason, "mine.py:3, in act: no");
  EXPECT_FALSE(read[1].left_nothing());
}

TEST_F(OnDiskTest, ReportsAndIgnoresEpisodesOfAnotherRun) {
  RunConfig other = run;
  other.seed = 7;
  WriteOf(other, "e", true);
  const ItemOnDisk found = LookForItem(run, item);
  EXPECT_FALSE(found.success || found.complete);
  EXPECT_THAT(found.broken, ElementsAre("'" + (folder / "e").string() +
                                        "' is an episode of another run (seed: 7 then, 0 now): "
                                        "move it away yourself"));
  for (const auto& look : std::vector<std::function<void()>>{[&] { IsComplete(run, item); },
                                                             [&] { KeptAttempt(run, item, 0); }}) {
    EXPECT_EQ(ExpectThrow<IoError>(look, "of another run"), found.broken.front())
        << "repair is no advice here";
  }
}

TEST_F(OnDiskTest, ReportsAndIgnoresARenamedEpisode) {
  Write("f", true);
  fs::rename(folder / "f", folder / "e");
  EXPECT_FALSE(LookForItem(run, item).success);
  ExpectThrow<IoError>([&] { IsComplete(run, item); }, "holds episode 'f'");
}

TEST_F(OnDiskTest, IgnoresEpisodesOfOtherVersionsOrMakers) {
  WriteOf(run, "a", true, {}, "3.9.0");
  EXPECT_THAT(LookForItem(run, {.id = "a"}).broken,
              ElementsAre(HasSubstr("of another run (mujoco: 3.9.0 then, ")));
  EpisodeSchema schema;
  const ColumnId time = schema.AddColumn({.name = "time"});
  EpisodeWriter writer(folder.path(), "b", schema);
  writer.Put(time, 0.0);
  writer.EndRow();
  writer.Commit({.success = true});
  EXPECT_THAT(LookForItem(run, {.id = "b"}).broken,
              ElementsAre(HasSubstr("is an episode that no run made")));
}

TEST_F(OnDiskTest, NamesInvalidMetadata) {
  run.keep = Keep::kAll;
  WriteOf(run, "e_a00", true, {{kEarlierAttempts, {1}}});
  EXPECT_THAT(LookForItem(run, item).broken,
              ElementsAre(HasSubstr("its earlier_attempts cannot be read")));
}

TEST_F(OnDiskTest, ReportsAPlanByItsItems) {
  Write("a", true);
  AtomicWrite(folder / "b", "in the way");
  const PlanOnDisk found = LookForItems(run, {{.id = "a"}, {.id = "b"}, {.id = "c"}});
  EXPECT_THAT(found.made, ElementsAre("a"));
  EXPECT_THAT(found.broken, ElementsAre(HasSubstr("move it away yourself")));
}

TEST_F(OnDiskTest, NamesABrokenAttemptBeforeASuccess) {
  run.keep = Keep::kAll;
  Write("e_a01", true);
  fs::create_directory(folder / "e_a00");
  AtomicWrite(folder / "e_a00/episode.json", "{");
  EXPECT_TRUE(LookForItem(run, item).success);
  ExpectThrow<IoError>([&] { IsComplete(run, item); }, "e_a00");
  EXPECT_THAT(LookForItems(run, {item}).broken, ElementsAre(HasSubstr("e_a00")));
}

}  // namespace
}  // namespace robocell
