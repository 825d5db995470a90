#include "robocell/data/episode_commit.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/data/dataset.h"
#include "robocell/data/episode_reader.h"
#include "robocell/data/testing/sample_episode.h"
#include "robocell/data/verify.h"
#include "robocell/testing/as_nobody.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using Json = nlohmann::ordered_json;

TEST(EpisodeCommit, EpisodeJsonRecordsContentsAndVersions) {
  TempDir folder;
  const Json json = Json::parse(Episode(SampleEpisode(17).Write(folder.path(), "pick-000")).json());
  EXPECT_EQ(json["format"], "robocell-episode");
  EXPECT_EQ(json["metadata"]["seed"], 17);
  EXPECT_EQ(json["versions"]["mujoco"], "4.0.0");
  EXPECT_THAT(json["versions"]["ffmpeg"].get<std::string>(), HasSubstr("ffmpeg version"));
  EXPECT_THAT(json["versions"]["encoder"].get<std::string>(), HasSubstr("x264"));
  EXPECT_EQ(json["files"]["scene.mjb"]["bytes"], 12);
  EXPECT_EQ(json["cameras"]["wrist"]["fps"], Json({500, 33}));
  EXPECT_EQ(json["run"]["worker"], 3);
  EXPECT_FALSE(json["run"]["started"].get<std::string>().empty());
}

TEST(EpisodeCommit, AnEpisodeIsNeverReplaced) {
  TempDir folder;
  const SampleEpisode sample;
  EpisodeWriter late(folder.path(), "pick-000", sample.schema);
  sample.PutRows(late, 2);
  sample.Write(folder.path(), "pick-000", 4);
  ExpectThrow<IoError>(
      [&] { sample.Write(folder.path(), "pick-000"); },
      "episode 'pick-000' is not saved: '" + (folder / "pick-000").string() + "' exists already");
  ExpectThrow<IoError>([&] { late.Commit({}); }, "File exists");
  EXPECT_EQ(Episode(folder / "pick-000").rows(), 4);
  EXPECT_TRUE(Verify(folder.path()).ok());
}

TEST(EpisodeCommit, KeepsAFileThatTakesTheNameOfTheEpisode) {
  TempDir folder;
  const SampleEpisode sample(0, false);
  const auto refused = [&](const std::string& id, const auto& appear) {
    EpisodeWriter writer(folder.path(), id, sample.schema);
    sample.PutRows(writer, 2);
    appear(folder / id);
    ExpectThrow<IoError>([&] { writer.Commit({}); }, "File exists");
  };
  refused("file", [](const fs::path& path) { AtomicWrite(path, "somebody's notes"); });
  EXPECT_EQ(ReadFile(folder / "file"), "somebody's notes");
  refused("link", [](const fs::path& path) { fs::create_symlink("elsewhere", path); });
  EXPECT_EQ(fs::read_symlink(folder / "link"), "elsewhere");
  refused("full", [](const fs::path& path) {
    fs::create_directory(path);
    AtomicWrite(path / "mine", "");
  });
  EXPECT_TRUE(fs::exists(folder / "full/mine"));

  EpisodeWriter writer(folder.path(), "empty", sample.schema);
  sample.PutRows(writer, 2);
  fs::create_directory(folder / "empty");
  EXPECT_EQ(writer.Commit({}), folder / "empty") << "an empty folder is in nobody's way";
  EXPECT_EQ(Episode(folder / "empty").rows(), 2);
}

// The folder may be written but not read: the rename works, flushing it does not.
TEST(EpisodeCommit, DoesNotReportACommittedEpisodeAsLost) {
  TempDir folder;
  const SampleEpisode sample(0, false);
  if (geteuid() == 0) {
    ASSERT_EQ(chown(folder.path().c_str(), kNobody, kNobody), 0);
  }
  const std::string message = MessageAsNobody([&] {
    EpisodeWriter writer(folder.path(), "e", sample.schema);  // must not undo the commit
    sample.PutRows(writer, 3);
    fs::permissions(folder.path(), fs::perms(0333));
    writer.Commit({});
  });
  fs::permissions(folder.path(), fs::perms(0755));
  EXPECT_THAT(message,
              StartsWith("episode 'e': '" + (folder / "e").string() + "' is in place, but"));
  EXPECT_EQ(Episode(folder / "e").rows(), 3);
  EXPECT_TRUE(Verify(folder.path()).ok());
}

TEST(EpisodeCommit, RejectsReservedKeys) {
  EpisodeSummary summary;
  summary.run_json = R"({"worker": 3})";
  const internal::EpisodeResults results("episode 'a'", "then", summary);
  EXPECT_EQ(results.run["worker"], 3);
  EXPECT_EQ(results.run["started"], "then");
  summary.run_json = R"({"host": "mine"})";
  ExpectThrow<ArgumentError>(
      [&] { internal::EpisodeResults("episode 'a'", "then", summary); },
      "episode 'a': run_json must not have 'host', it is added by the writer");
  summary.run_json = "[1]";
  ExpectThrow<ArgumentError>([&] { internal::EpisodeResults("episode 'a'", "then", summary); },
                             "episode 'a': run_json must be a JSON object, got array");
}

// Writes episodes until it is killed; acknowledges each committed one with a byte.
[[noreturn]] void WriteForEver(const SampleEpisode& sample, const fs::path& dataset, int round,
                               int acknowledge) {
  for (int i = 0;; ++i) {
    sample.Write(dataset, "round" + std::to_string(round) + "-" + std::to_string(i), 70);
    if (write(acknowledge, "x", 1) != 1) _exit(1);
  }
}

TEST(EpisodeCommit, AKilledProcessLeavesOnlyCompleteEpisodes) {
  TempDir folder;
  const SampleEpisode sample(0, false);
  size_t acknowledged = 0;
  constexpr int kRounds = 12;
  for (int round = 0; round < kRounds; ++round) {
    int ends[2];
    ASSERT_EQ(pipe(ends), 0);
    const pid_t pid = fork();
    if (pid == 0) WriteForEver(sample, folder.path(), round, ends[1]);
    close(ends[1]);
    char byte;
    ASSERT_EQ(read(ends[0], &byte, 1), 1);  // at least one is committed
    std::this_thread::sleep_for(std::chrono::microseconds(700 * round));
    kill(pid, SIGKILL);
    waitpid(pid, nullptr, 0);
    ++acknowledged;
    while (read(ends[0], &byte, 1) == 1) ++acknowledged;
    close(ends[0]);
  }
  const VerifyResult report = Verify(folder.path());
  EXPECT_TRUE(report.ok()) << report.Text();
  EXPECT_GE(report.good.size(), acknowledged);
  EXPECT_LE(report.good.size(), acknowledged + kRounds);  // one committed, not yet acknowledged
}

}  // namespace
}  // namespace robocell::internal
