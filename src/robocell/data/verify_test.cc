#include "robocell/data/verify.h"

#include <sys/stat.h>
#include <unistd.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <tuple>

#include "robocell/base/checked_json.h"
#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/hash.h"
#include "robocell/data/dataset.h"
#include "robocell/data/testing/dataset_of_three.h"
#include "robocell/data/testing/sample_episode.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

class VerifyTest : public DatasetOfThree {};

TEST_F(VerifyTest, AnIntactDatasetHasNoProblems) {
  WriteManifest(folder_.path(), "{}");
  const VerifyResult result = Verify(folder_.path(), {.decode_videos = true});
  EXPECT_TRUE(result.ok()) << result.Text();
  EXPECT_THAT(result.good, ElementsAre("a", "b", "c"));
  EXPECT_EQ(result.Text(), "3 episodes intact, 0 damaged\n");
  fs::remove_all(folder_ / "a");
  fs::remove_all(folder_ / "b");
  EXPECT_EQ(Verify(folder_.path()).Text(), "1 episode intact, 0 damaged\n");
}

TEST_F(VerifyTest, AMissingDescriptionIsNamed) {
  fs::remove(B("episode.json"));
  EXPECT_THAT(OnlyProblem(),
              HasSubstr("b/episode.json: it is missing: the episode was never finished"));
}

TEST_F(VerifyTest, NamesAndQuarantinesAForeignFileButNotItsEpisode) {
  Store(B(".DS_Store"), "x");
  const VerifyResult result = Verify(folder_.path());
  EXPECT_THAT(result.Text(), HasSubstr("b/.DS_Store: it does not belong to the episode"));
  EXPECT_THAT(result.good, ElementsAre("a", "b", "c"));
  EXPECT_FALSE(result.ok());
  EXPECT_FALSE(result.only_unreadable());
  EXPECT_THAT(Repair(folder_.path()).moved, ElementsAre(".DS_Store"));
  EXPECT_TRUE(Verify(folder_.path()).ok());
}

// Findings against an episode that only concern this machine or version.
class Unjudged : public VerifyTest {
 protected:
  // Expects a report with `reason`, no move, and the same report again.
  void ExpectLeftAlone(const std::string& reason, const VerifyOptions& options = {}) {
    const VerifyResult result = Verify(folder_.path(), options);
    EXPECT_THAT(result.unjudged, ElementsAre("b"));
    EXPECT_THAT(result.bad, IsEmpty());
    EXPECT_TRUE(result.only_unreadable());
    EXPECT_THAT(result.Text(), HasSubstr(reason));
    EXPECT_THAT(result.Text(), HasSubstr("2 episodes intact, 0 damaged, 1 not judged"));
    const RepairResult repaired = Repair(folder_.path(), options);
    EXPECT_THAT(repaired.moved, IsEmpty());
    ASSERT_EQ(repaired.remaining.size(), 1u);
    EXPECT_THAT(repaired.remaining[0].Text(), HasSubstr(reason));
  }
};

// In another version the list of files may be elsewhere.
TEST_F(Unjudged, AnEpisodeOfAnotherFormatVersion) {
  std::string text = ReadFile(B("episode.json"));
  const std::string version = "\"format_version\": 1";
  text.replace(text.find(version), version.size(), "\"format_version\": 2");
  text.replace(text.find("\"files\""), 7, "\"parts\"");
  const size_t hash = text.find("\"json_sha256\": \"") + 16;
  text.replace(hash, kHashPlaceholder.size(), kHashPlaceholder);
  Store(B("episode.json"), InsertSelfHash(text));
  ExpectLeftAlone("b/episode.json: format version 2 is not 1, which this robocell reads");
}

// Root, which runs tests in containers, may read everything.
class AsNobody {
 public:
  AsNobody() { EXPECT_TRUE(root_ != 0 || seteuid(65534) == 0); }
  ~AsNobody() { EXPECT_TRUE(root_ != 0 || seteuid(0) == 0); }

 private:
  uid_t root_ = geteuid();
};

TEST_F(Unjudged, UnreadableFiles) {
  for (const char* name : {"steps.h5", "episode.json", ""}) {
    const fs::path path = folder_ / "b" / name;
    const fs::perms before = fs::status(path).permissions();
    fs::permissions(folder_.path(), fs::perms(0755));
    fs::permissions(path, fs::perms::none);
    {
      const AsNobody nobody;
      const VerifyResult result = Verify(folder_.path());
      EXPECT_THAT(result.unjudged, ElementsAre("b"));
      EXPECT_THAT(result.bad, IsEmpty());
      EXPECT_THAT(result.Text(), HasSubstr("Permission denied"));
      EXPECT_EQ(Dataset(folder_.path()).Open("c").Read<double>("time").size(), 10u);
    }
    fs::permissions(path, before);
  }
}

// For example in a cache that several users share: the episodes are judged all the same.
TEST_F(VerifyTest, UnreadableModelsHideNoEpisode) {
  const std::string sums = Sha256("<mujoco/>") + "  arm.xml\n";
  const std::string model = "models/arm-" + Sha256(sums).substr(0, 16);
  fs::create_directories(folder_ / model);
  Store(folder_ / model / "arm.xml", "<mujoco/>");
  Store(folder_ / model / "SHA256SUMS", sums);
  fs::create_directory(folder_ / ".quarantine");
  fs::permissions(folder_.path(), fs::perms(0755));
  ASSERT_TRUE(Verify(folder_.path()).ok()) << Verify(folder_.path()).Text();
  const auto none = fs::perms::none;
  const auto list_only = fs::perms(0444);
  for (const auto& [closed, perms, message] :
       {std::tuple{std::string("models"), none, std::string("models: cannot list '")},
        std::tuple{std::string("models"), list_only, std::string("models: cannot look into '")},
        std::tuple{model, none, model + ": cannot list '"},
        std::tuple{std::string(".quarantine"), none, std::string(".quarantine: cannot list '")}}) {
    const fs::perms before = fs::status(folder_ / closed).permissions();
    fs::permissions(folder_ / closed, perms);
    {
      const AsNobody nobody;
      const VerifyResult result = Verify(folder_.path());
      EXPECT_THAT(result.good, ElementsAre("a", "b", "c"));
      ASSERT_EQ(result.problems.size(), 1u) << result.Text();
      EXPECT_THAT(result.problems[0].Text(),
                  AllOf(StartsWith(message), HasSubstr("': Permission denied")));
      EXPECT_TRUE(result.only_unreadable());
      EXPECT_THAT(result.bad_parts, IsEmpty());
      EXPECT_THAT(result.foreign, IsEmpty());
    }
    fs::permissions(folder_ / closed, before);
  }
}

TEST_F(VerifyTest, AMissingDecoderIsAnError) {
  setenv("ROBOCELL_FFMPEG", "/no/ffmpeg", 1);
  ExpectThrow<IoError>([&] { Repair(folder_.path(), {.decode_videos = true}); },
                       "ROBOCELL_FFMPEG is '/no/ffmpeg', which is not an executable file");
  unsetenv("ROBOCELL_FFMPEG");
  EXPECT_TRUE(Verify(folder_.path(), {.decode_videos = true}).ok());
}

TEST_F(VerifyTest, IgnoresALinkCycle) {
  fs::create_symlink("loop", folder_ / "loop");
  const VerifyResult result = Verify(folder_.path());
  EXPECT_TRUE(result.ok()) << result.Text();
  EXPECT_THAT(result.others, ElementsAre("loop"));
  EXPECT_EQ(Dataset(folder_.path()).ids().size(), 3u);
}

TEST_F(VerifyTest, ARenamedEpisodeIsNamed) {
  fs::rename(folder_ / "b", folder_ / "d");
  const VerifyResult result = Verify(folder_.path());
  ASSERT_EQ(result.problems.size(), 1u);
  EXPECT_EQ(result.problems[0].Text(),
            "d/episode.json: it describes episode 'b': the folder was copied or renamed, and does "
            "not count. Remove the copy, or give the folder its name back");
}

TEST_F(VerifyTest, ReportsLeftoversAndForeignFoldersWithoutAProblem) {
  const SampleEpisode sample(0, false);
  EpisodeWriter running(folder_.path(), "d", sample.schema);
  fs::create_directory(folder_ / ".e.99999999.1.partial");
  fs::create_directory(folder_ / "logs");
  const std::string account =
      InsertSelfHash("{\"json_sha256\": \"" + std::string(kHashPlaceholder) + "\"}");
  Store(folder_ / "report.json", account);
  Store(folder_ / "report-0-of-2.json", account);
  const VerifyResult result = Verify(folder_.path());
  EXPECT_TRUE(result.ok());
  EXPECT_THAT(result.leftovers, ElementsAre(".e.99999999.1.partial"));
  EXPECT_EQ(result.being_written.size(), 1u);
  EXPECT_THAT(result.others, ElementsAre("logs"));
  EXPECT_THAT(result.Text(),
              HasSubstr(".e.99999999.1.partial: unfinished, left behind by a crash"));
  EXPECT_THAT(result.Text(), HasSubstr("unfinished, a running process is writing it"));
}

TEST_F(VerifyTest, ADamagedManifestIsNamed) {
  Store(folder_ / "dataset.json", "{");
  const VerifyResult result = Verify(folder_.path());
  EXPECT_FALSE(result.ok());
  EXPECT_THAT(result.Text(), HasSubstr("dataset.json"));
  EXPECT_THAT(result.good, ElementsAre("a", "b", "c"));
}

TEST_F(VerifyTest, RepairQuarantinesBadEpisodesAndDeletesNothing) {
  fs::resize_file(B("steps.h5"), 10);
  fs::create_directory(folder_ / ".e.99999999.1.partial");
  const SampleEpisode sample(0, false);
  EpisodeWriter running(folder_.path(), "d", sample.schema);
  const RepairResult result = Repair(folder_.path());
  EXPECT_THAT(result.moved, ElementsAre("b", ".e.99999999.1.partial"));
  EXPECT_EQ(fs::file_size(folder_ / ".quarantine" / "b" / "steps.h5"), 10u);
  const VerifyResult after = Verify(folder_.path());
  EXPECT_TRUE(after.ok()) << after.Text();
  EXPECT_THAT(after.good, ElementsAre("a", "c"));
  sample.PutRow(running, 0);
  running.Commit({});  // was not disturbed
  SampleEpisode('b').Write(folder_.path(), "b", 10);
  fs::resize_file(B("steps.h5"), 10);
  EXPECT_THAT(Repair(folder_.path()).moved, ElementsAre("b.1"));
}

// A process number proves nothing: it may be another machine's, or may have been reused since.
TEST_F(VerifyTest, RepairDetectsAWriterByItsLock) {
  const std::string name = fmt::format(".e.{}.7.partial", getpid());
  fs::create_directory(folder_ / name);
  EXPECT_THAT(Repair(folder_.path()).moved, ElementsAre(name));
}

TEST_F(VerifyTest, ReportsProgress) {
  std::vector<size_t> done;
  Verify(folder_.path(), {.progress = [&](size_t n, size_t total) {
           EXPECT_EQ(total, 3u);
           done.push_back(n);
         }});
  EXPECT_THAT(done, ElementsAre(1, 2, 3));
}

TEST(Verify, AMissingDatasetIsNamed) {
  ExpectThrow<IoError>([] { Verify("/no/such/folder"); }, "/no/such/folder");
}

TEST_F(VerifyTest, RejectsANonDatasetAndNamesANearbyOne) {
  TempDir around;
  ExpectThrow<ArgumentError>(
      [&] { Verify(around.path()); },
      "' is not a dataset: it has neither a dataset.json nor episodes, it is "
      "empty");
  fs::copy(folder_.path(), around / "set", fs::copy_options::recursive);
  WriteManifest(around / "set", "{}");
  Store(around / "notes.txt", "x");
  const std::string text =
      ExpectThrow<ArgumentError>([&] { Verify(around.path()); }, "it holds notes.txt, set. ");
  EXPECT_THAT(text, HasSubstr("Did you mean '" + (around / "set").string() + "'?"));
  ExpectThrow<ArgumentError>([&] { Repair(around.path()); }, "is not a dataset");
  ExpectThrow<ArgumentError>([&] { Dataset{around.path()}; }, text);
  fs::create_directory(around / "set" / "notes");
  ExpectThrow<ArgumentError>([&] { Verify(around / "set" / "notes" / ""); },
                             "It is a part of a dataset; give '" + (around / "set").string());
  fs::copy(around / "set", around / "two", fs::copy_options::recursive);
  ExpectThrow<ArgumentError>([&] { Verify(around.path()); },
                             ". It holds 2 datasets, give one of them: " +
                                 (around / "set").string() + ", " + (around / "two").string());
  EXPECT_FALSE(fs::exists(around / ".lock")) << "nothing is written into it";
  ExpectThrow<ArgumentError>([&] { Verify(around / "set" / "a"); },
                             "It is an episode of a dataset; give '" + (around / "set").string());
}

// An opened pipe would wait for ever, and a device would never end.
TEST_F(VerifyTest, NamesPipesLinksAndDevicesWithoutOpeningThem) {
  for (const char* file : {"episode.json", "steps.h5"}) {
    fs::remove(B(file));
    ASSERT_EQ(::mkfifo(B(file).c_str(), 0600), 0);
    EXPECT_EQ(OnlyProblem(), fmt::format("b/{}: it is a pipe, not a file", file));
    fs::remove(B(file));
    fs::create_symlink("/dev/zero", B(file));
    EXPECT_EQ(OnlyProblem(), fmt::format("b/{}: it is a link to '/dev/zero', not a file", file));
    EXPECT_THROW(Episode{folder_ / "b"}, IoError);
    fs::remove(B(file));
    fs::copy(Original() / ("b/" + std::string(file)), B(file));
  }
}

TEST_F(VerifyTest, DoesNotReadAHugeDescription) {
  fs::resize_file(B("episode.json"), uint64_t{1} << 40);
  EXPECT_THAT(OnlyProblem(), HasSubstr("it has 1099511627776 bytes, 67108864 are the most"));
}

TEST_F(VerifyTest, QuarantinesAManifestThatIsAPipe) {
  ASSERT_EQ(::mkfifo((folder_ / "dataset.json").c_str(), 0600), 0);
  const VerifyResult result = Verify(folder_.path());
  ASSERT_EQ(result.problems.size(), 1u) << result.Text();
  EXPECT_THAT(result.problems[0].Text(), HasSubstr("dataset.json': it is a pipe, not a file"));
  EXPECT_THAT(Repair(folder_.path()).moved, ElementsAre("dataset.json"));
}

TEST_F(VerifyTest, RepairMovesNothingThroughALink) {
  TempDir elsewhere;
  fs::resize_file(B("steps.h5"), 1);
  for (const char* name : {".quarantine", "models", ".logs"}) {
    fs::create_directory_symlink(elsewhere.path(), folder_ / name);
    const std::string what = fmt::format("it is a link to '{}'", elsewhere.path().string());
    const std::string text = ExpectThrow<IoError>([&] { Repair(folder_.path()); }, what);
    EXPECT_THAT(text, HasSubstr((folder_ / name).string()));
    EXPECT_THAT(text, HasSubstr("Remove it, or replace it with its target"));
    EXPECT_THAT(Verify(folder_.path()).Text(), HasSubstr(fmt::format("{}: {}", name, what)));
    fs::remove(folder_ / name);
  }
  EXPECT_TRUE(fs::is_empty(elsewhere.path()));
  EXPECT_THAT(Repair(folder_.path()).moved, ElementsAre("b"));
}

}  // namespace
}  // namespace robocell
