#include "robocell/data/episode_state.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/files.h"
#include "robocell/data/dataset.h"
#include "robocell/data/testing/sample_episode.h"
#include "robocell/data/verify.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class EpisodeStateTest : public ::testing::Test {
 protected:
  void ExpectBroken(const std::string& text) const {
    const EpisodeLook look = LookAtEpisode(e());
    EXPECT_EQ(look.state, EpisodeState::kBroken);
    EXPECT_FALSE(look.success);
    EXPECT_THAT(look.problem, HasSubstr(text));
    EXPECT_THAT(look.problem, HasSubstr(e().string()));
  }
  fs::path e() const { return folder_ / "e"; }

  TempDir folder_;
};

TEST_F(EpisodeStateTest, NothingAndAnEmptyFolderAreAbsent) {
  EXPECT_EQ(LookAtEpisode(e()).state, EpisodeState::kAbsent);
  fs::create_directory(e());
  EXPECT_EQ(LookAtEpisode(e()).state, EpisodeState::kAbsent);
  WriteManifest(folder_.path(), "{}");
  EXPECT_THAT(Dataset(folder_.path()).ids(), IsEmpty());
}

TEST_F(EpisodeStateTest, AnEmptyFolderDoesNotBlockTheEpisode) {
  fs::create_directory(e());
  SampleEpisode(0, false).Write(folder_.path(), "e");
  EXPECT_EQ(LookAtEpisode(e()).state, EpisodeState::kWhole);
  EXPECT_TRUE(Verify(folder_.path()).ok());
}

TEST_F(EpisodeStateTest, ACommittedEpisodeIsWhole) {
  SampleEpisode(0, false).Write(folder_.path(), "e");
  const EpisodeLook look = LookAtEpisode(e());
  EXPECT_EQ(look.state, EpisodeState::kWhole);
  EXPECT_EQ(look.success, Episode(e()).success());
}

TEST_F(EpisodeStateTest, AnIncompleteEpisodeIsBrokenAndQuarantined) {
  SampleEpisode(0, false).Write(folder_.path(), "e");
  fs::remove(e() / "episode.json");
  ExpectBroken("half an episode: episode.json is missing");
  EXPECT_THAT(Dataset(folder_.path()).ids(), IsEmpty());
  EXPECT_THAT(Repair(folder_.path()).moved, ElementsAre("e"));
  EXPECT_EQ(LookAtEpisode(e()).state, EpisodeState::kAbsent);
}

TEST_F(EpisodeStateTest, DamageIsNamed) {
  SampleEpisode(0, false).Write(folder_.path(), "e");
  fs::resize_file(e() / "steps.h5", 100);
  ExpectBroken("steps.h5");
  AtomicWrite(e() / "episode.json", "{");
  ExpectBroken("episode.json");
}

TEST_F(EpisodeStateTest, ACopiedOrRenamedEpisodeIsBroken) {
  SampleEpisode(0, false).Write(folder_.path(), "f");
  EXPECT_EQ(OtherIdIn(folder_ / "f"), std::nullopt);
  fs::copy(folder_ / "f", e());
  EXPECT_EQ(OtherIdIn(e()), "f");
  ExpectBroken(
      "' holds episode 'f': it was copied or renamed, and does not count. Remove the copy");
  EXPECT_THAT(Repair(folder_.path()).moved, ElementsAre("e"));
  AtomicWrite(folder_ / "f/episode.json", "{\n  \"id\": \"g");
  EXPECT_EQ(OtherIdIn(folder_ / "f"), std::nullopt) << "damage is told as that";
  EXPECT_EQ(OtherIdIn(folder_ / "none"), std::nullopt);
}

TEST_F(EpisodeStateTest, ReportsForeignFilesAndKeepsThem) {
  AtomicWrite(e(), "a file");
  ExpectBroken("is not a folder: repair leaves it alone, move it away yourself");
  fs::remove(e());
  fs::create_directory(e());
  AtomicWrite(e() / "thesis.txt", "x");
  ExpectBroken("contains something else: repair leaves it alone");
}

}  // namespace
}  // namespace robocell::internal
