#include "robocell/data/dataset_lock.h"

#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <barrier>
#include <filesystem>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/host.h"
#include "robocell/data/dataset.h"
#include "robocell/data/verify.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

using ::testing::ContainsRegex;
using ::testing::Each;
using ::testing::HasSubstr;

TEST(DatasetLock, IsHeldByOneAtATimeAndNamesItsOwner) {
  TempDir folder;
  std::optional<DatasetLock> lock(folder.path());
  const std::string text =
      ExpectThrow<IoError>([&] { DatasetLock other(folder.path()); }, "in use");
  EXPECT_THAT(text, HasSubstr(folder.path().string()));
  EXPECT_THAT(text, HasSubstr("by process " + std::to_string(getpid()) + " on "));
  EXPECT_THAT(text, HasSubstr("take another folder"));
  lock.reset();
  EXPECT_NO_THROW(DatasetLock again(folder.path()));
}

std::string Refusal(const std::filesystem::path& dataset) {
  return ExpectThrow<IoError>([&] { DatasetLock other(dataset); }, "in use");
}

// The next holder has not written its name yet.
TEST(DatasetLock, NamesNoProcessThatHasEnded) {
  TempDir folder;
  { const DatasetLock former(folder.path()); }
  const std::string mine = ReadFile(folder / ".lock");
  const auto held = FileLock::Try(folder / ".lock", LockKind::kExclusive);
  EXPECT_THAT(Refusal(folder.path()), HasSubstr("in use by process " + std::to_string(getpid())));
  EXPECT_THAT(Refusal(folder.path()), ContainsRegex(" since 20[0-9-]+T[0-9:]+Z\\. Wait until"));
  for (const std::string& other :
       {"process 999999999 on " + internal::HostName() + "\nsince 7\n",  // no such process
        mine.substr(0, mine.find("since")) + "since 7\n",                // another process
        "process " + std::to_string(getpid()) + " on " + internal::HostName()}) {  // unknown owner
    AtomicWrite(folder / "text", other);
    std::filesystem::copy_file(folder / "text", folder / ".lock",
                               std::filesystem::copy_options::overwrite_existing);
    EXPECT_THAT(Refusal(folder.path()), HasSubstr("' is in use. Wait")) << other;
  }
}

TEST(DatasetLock, NamesTheShardsAndWritersThatShareIt) {
  TempDir folder;
  { const DatasetLock former(folder.path()); }
  const DatasetLock shard(folder.path(), 3, 8), other(folder.path(), 0, 8);
  const std::string me =
      "\\(process " + std::to_string(getpid()) + " on " + internal::HostName() + " since [^)]*Z\\)";
  EXPECT_THAT(Refusal(folder.path()),
              ContainsRegex("in use by shards: 0-of-8 " + me + ", 3-of-8 " + me + "\\. Wait"));
  const DatasetLock writer = DatasetLock::Writing(folder.path());
  EXPECT_THAT(ExpectThrow<IoError>([&] { DatasetLock::Alone(folder.path()); }, "in use"),
              HasSubstr("in use by "));
}

TEST(DatasetLock, ShardsShareTheFolderButNotAShard) {
  TempDir folder;
  const DatasetLock first(folder.path(), 0, 2);
  std::optional<DatasetLock> second(std::in_place, folder.path(), 1, 2);
  EXPECT_THROW(DatasetLock(folder.path(), 1, 2), IoError);
  EXPECT_THROW(DatasetLock whole(folder.path()), IoError);
  second.reset();
  EXPECT_NO_THROW(DatasetLock(folder.path(), 1, 2));
}

// Each checks whether the locks of the others are held.
TEST(DatasetLock, ConcurrentShardsDoNotRejectEachOther) {
  constexpr int kShards = 8, kRounds = 200;
  TempDir folder;
  std::barrier together(kShards);
  std::vector<std::string> refused(kShards);
  const auto take = [&](int shard) {
    try {
      const DatasetLock lock(folder.path(), shard, kShards);
      together.arrive_and_wait();  // all of them hold their locks
    } catch (const IoError& error) {
      refused[static_cast<size_t>(shard)] = error.what();
      together.arrive_and_wait();
    }
  };
  std::vector<std::thread> threads;
  for (int shard = 0; shard < kShards; ++shard) {
    threads.emplace_back([&, shard] {
      for (int i = 0; i < kRounds; ++i) {
        together.arrive_and_wait();
        take(shard);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_THAT(refused, Each(""));
}

// Both would make the same episodes; rejecting both would leave none at work.
TEST(DatasetLock, OneOfTwoConcurrentShardCountsWins) {
  constexpr int kRounds = 100;
  TempDir folder;
  std::barrier together(2);
  std::vector<int> taken(2);
  std::vector<std::string> refused(2);
  const auto run = [&](int shard) {
    for (int i = 0; i < kRounds; ++i) {
      together.arrive_and_wait();
      std::optional<DatasetLock> lock;
      try {
        lock.emplace(folder.path(), 0, 2 + shard);
        ++taken[static_cast<size_t>(shard)];
      } catch (const IoError& error) {
        refused[static_cast<size_t>(shard)] = error.what();
      }
      together.arrive_and_wait();  // the winner holds its lock until here
    }
  };
  std::thread other(run, 1);
  run(0);
  other.join();
  EXPECT_EQ(taken[0] + taken[1], kRounds) << refused[0] << "\n" << refused[1];
  for (const std::string& text : refused)
    EXPECT_TRUE(text.empty() || text.find("give all shards the same N") != text.npos) << text;
}

TEST(DatasetLock, RejectsShardsOfDifferentCounts) {
  TempDir folder;
  std::optional<DatasetLock> half(std::in_place, folder.path(), 0, 2);
  const std::string text =
      ExpectThrow<IoError>([&] { DatasetLock(folder.path(), 0, 3); }, "as a shard of 2");
  EXPECT_THAT(text, HasSubstr("give all shards the same N"));
  EXPECT_THAT(text, HasSubstr("by process " + std::to_string(getpid())));
  half.reset();
  const DatasetLock third(folder.path(), 0, 3);
  EXPECT_THROW(DatasetLock(folder.path(), 1, 2), IoError);
}

TEST(DatasetLock, WritersCoexistWithRunsButNotWithARepair) {
  TempDir folder;
  WriteManifest(folder.path(), "{}");
  std::optional<DatasetLock> writer = DatasetLock::Writing(folder.path());
  EXPECT_NO_THROW(DatasetLock::Writing(folder.path()));
  EXPECT_NO_THROW(DatasetLock run(folder.path()));
  ExpectThrow<IoError>([&] { Repair(folder.path()); }, "in use by writers of episodes");
  writer.reset();
  const DatasetLock alone = DatasetLock::Alone(folder.path());
  EXPECT_THROW(DatasetLock::Writing(folder.path()), IoError);
  EXPECT_THROW(DatasetLock run(folder.path()), IoError);
}

TEST(DatasetLock, OfAKilledProcessIsReleased) {
  TempDir folder;
  int pipe[2];
  ASSERT_EQ(::pipe(pipe), 0);
  const pid_t child = fork();
  if (child == 0) {
    const DatasetLock lock(folder.path());
    [[maybe_unused]] const ssize_t n = write(pipe[1], "!", 1);
    pause();
    _exit(0);
  }
  char byte;
  ASSERT_EQ(read(pipe[0], &byte, 1), 1);
  EXPECT_THROW(DatasetLock busy(folder.path()), IoError);
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  EXPECT_NO_THROW(DatasetLock again(folder.path()));
  close(pipe[0]);
  close(pipe[1]);
}

TEST(DatasetLock, RepairRejectsADatasetInUse) {
  TempDir folder;
  WriteManifest(folder.path(), "{}");
  const DatasetLock run(folder.path(), 3, 8);
  ExpectThrow<IoError>([&] { Repair(folder.path()); }, "in use");
}

TEST(DatasetLock, AMissingFolderIsNamed) {
  ExpectThrow<IoError>([] { DatasetLock lock("/no/such/folder"); }, "/no/such/folder");
}

TEST(DatasetLock, RejectsLinksAndPipes) {
  TempDir folder, elsewhere;
  AtomicWrite(elsewhere / "precious", "text");
  const auto expect_refused = [&](const std::string& what) {
    const std::string text = ExpectThrow<IoError>([&] { DatasetLock lock(folder.path()); }, what);
    EXPECT_THAT(text, HasSubstr((folder / ".lock").string()));
    EXPECT_THAT(text, HasSubstr("Remove it"));
  };
  std::filesystem::create_symlink(elsewhere / "precious", folder / ".lock");
  expect_refused("it is a link to '" + (elsewhere / "precious").string() + "', not a file");
  std::filesystem::remove(folder / ".lock");
  std::filesystem::create_symlink(elsewhere / "new", folder / ".lock");
  expect_refused("it is a link to ");
  std::filesystem::remove(folder / ".lock");
  ASSERT_EQ(::mkfifo((folder / ".lock").c_str(), 0600), 0);
  expect_refused("it is a pipe, not a file");
  EXPECT_EQ(ReadFile(elsewhere / "precious"), "text");
  EXPECT_FALSE(std::filesystem::exists(elsewhere / "new"));
}

TEST(DatasetLock, RejectsLogFoldersThatAreLinks) {
  TempDir folder, elsewhere;
  std::filesystem::create_directory(folder / ".logs");
  AtomicWrite(folder / ".logs/worker-0.log", "kept");
  EXPECT_NO_THROW(DatasetLock lock(folder.path()));
  std::filesystem::create_symlink(elsewhere / "new", folder / ".logs/worker-1.log");
  ExpectThrow<IoError>([&] { DatasetLock lock(folder.path()); },
                       ".logs/worker-1.log': it is a link to ");
}

}  // namespace
}  // namespace robocell
