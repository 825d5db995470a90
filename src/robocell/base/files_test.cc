#include "robocell/base/files.h"

#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/temporary_name.h"
#include "robocell/testing/as_nobody.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;
using ::testing::AnyOf;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::StartsWith;

class FilesTest : public ::testing::Test {
 protected:
  const fs::path& root() const { return temp_.path(); }
  std::vector<std::string> Names(const fs::path& folder) const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder))
      names.push_back(entry.path().filename());
    std::sort(names.begin(), names.end());
    return names;
  }

 private:
  TempDir temp_;
};

TEST_F(FilesTest, ReadsBackWhatItWrote) {
  std::string bytes;
  for (int i = 0; i < 300000; ++i) bytes.push_back(static_cast<char>(i * 7));
  for (const std::string& content :
       {std::string(), std::string("text\n"), std::string("a\0b", 3), bytes}) {
    AtomicWrite(root() / "file", content);
    EXPECT_EQ(ReadFile(root() / "file"), content);
  }
  EXPECT_THAT(Names(root()), ElementsAre("file"));
}

TEST_F(FilesTest, AcceptsUnusualAndLongNames) {
  for (const std::string name : {"with space", "$(rm -rf x)", "quote'\"", "\u00e4\u6f22", "-n"}) {
    AtomicWrite(root() / name, name);
    EXPECT_EQ(ReadFile(root() / name), name);
  }
  const std::string longest(255, 'x');
  AtomicWrite(root() / longest, "content");
  EXPECT_EQ(ReadFile(root() / longest), "content");
}

TEST_F(FilesTest, AFileWithoutSizeIsReadToItsEnd) {
  EXPECT_THAT(ReadFile("/proc/self/status"), HasSubstr("Name:"));
}

TEST_F(FilesTest, ReadingAMissingFileNamesItAndTheReason) {
  ExpectThrow<IoError>(
      [&] { ReadFile(root() / "nothing"); },
      "cannot read '" + (root() / "nothing").native() + "': No such file or directory");
  ExpectThrow<IoError>([&] { ReadFile(root()); }, "Is a directory");
}

TEST_F(FilesTest, WritingIntoAMissingFolderNamesItAndTheReason) {
  ExpectThrow<IoError>(
      [&] { AtomicWrite(root() / "no" / "file", "x"); },
      "cannot write '" + (root() / "no/file").native() + "': No such file or directory");
}

TEST_F(FilesTest, WritingOverAFolderIsAnErrorAndLeavesNoFile) {
  fs::create_directory(root() / "taken");
  ExpectThrow<IoError>([&] { AtomicWrite(root() / "taken", "x"); }, "Is a directory");
  EXPECT_THAT(Names(root()), ElementsAre("taken"));
}

TEST_F(FilesTest, AFailedWriteKeepsThePreviousFile) {
  AtomicWrite(root() / "file", "former");
  rlimit former_limit = {};
  ::getrlimit(RLIMIT_FSIZE, &former_limit);
  const rlimit limit = {1000, former_limit.rlim_max};
  const auto former_handler = ::signal(SIGXFSZ, SIG_IGN);
  ::setrlimit(RLIMIT_FSIZE, &limit);
  std::string message;
  try {
    AtomicWrite(root() / "file", std::string(5000, 'x'));
  } catch (const IoError& error) {
    message = error.what();
  }
  ::setrlimit(RLIMIT_FSIZE, &former_limit);
  ::signal(SIGXFSZ, former_handler);
  EXPECT_THAT(message, HasSubstr("file': File too large"));
  EXPECT_EQ(ReadFile(root() / "file"), "former");
  EXPECT_THAT(Names(root()), ElementsAre("file"));
}

TEST_F(FilesTest, AFullDiskErrorReportsTheMissingBytes) {
  const int full = ::open("/dev/full", O_WRONLY | O_CLOEXEC);
  ASSERT_GE(full, 0);
  const std::string message =
      ExpectThrow<IoError>([&] { WriteAll(full, "12345", root() / "steps.h5"); },
                           "cannot write '" + (root() / "steps.h5").native() +
                               "': No space left on device. 5 bytes are needed, ");
  EXPECT_THAT(message, HasSubstr(" are free there. Make room and try again."));
  ::close(full);
}

TEST_F(FilesTest, AClosedPipeIsAnError) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  ::close(ends[0]);
  const auto former = ::signal(SIGPIPE, SIG_IGN);
  ExpectThrow<IoError>([&] { WriteAll(ends[1], "x", "the pipe"); },
                       "cannot write 'the pipe': Broken pipe");
  ::signal(SIGPIPE, former);
  ::close(ends[1]);
}

TEST_F(FilesTest, InterruptedAndPartialWritesAreContinued) {
  struct sigaction action = {}, former = {};
  action.sa_handler = [](int) {};  // no SA_RESTART: system calls return EINTR or partial results
  ::sigaction(SIGUSR1, &action, &former);
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  std::string sent;
  for (unsigned i = 0; i < 2000000; ++i) sent.push_back(static_cast<char>(i * i >> 8));
  std::atomic<bool> done = false;
  std::thread writer([&] {
    WriteAll(ends[1], sent, "pipe");
    done = true;
    ::close(ends[1]);
  });
  // There is no reader yet: the first signal ends a partial write, the others find nothing written.
  for (int i = 0; i < 20; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ::pthread_kill(writer.native_handle(), SIGUSR1);
  }
  std::string received, block(5000, '\0');
  for (;;) {
    if (!done) ::pthread_kill(writer.native_handle(), SIGUSR1);
    const ssize_t count = ::read(ends[0], block.data(), block.size());
    if (count == 0) break;
    ASSERT_GT(count, 0);
    received.append(block, 0, static_cast<size_t>(count));
  }
  writer.join();
  ::close(ends[0]);
  ::sigaction(SIGUSR1, &former, nullptr);
  EXPECT_EQ(received.size(), sent.size());
  EXPECT_TRUE(received == sent);
}

// For a child process: it never returns into the test.
[[noreturn]] void WriteForever(const fs::path& path, const std::string& a, const std::string& b) {
  try {
    for (;;) {
      AtomicWrite(path, b);
      AtomicWrite(path, a);
    }
  } catch (...) {
    ::_exit(1);
  }
}

TEST_F(FilesTest, AKilledWriterLeavesTheOldOrTheNewContent) {
  const fs::path path = root() / "file";
  const std::string a(40000, 'a'), b(70000, 'b');
  AtomicWrite(path, a);
  for (int round = 0; round < 20; ++round) {
    const pid_t child = ::fork();
    if (child == 0) WriteForever(path, a, b);
    std::this_thread::sleep_for(std::chrono::microseconds(1000 + 137 * round));
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status)) << "the writer ended by itself";
    const std::string content = ReadFile(path);
    ASSERT_TRUE(content == a || content == b) << round;
  }
  for (const std::string& name : Names(root()))
    EXPECT_TRUE(name == "file" || IsTemporaryName(name));
}

TEST_F(FilesTest, WritersInManyThreadsDoNotMix) {
  const std::vector<std::string> contents = {std::string(30000, 'a'), std::string(50000, 'b')};
  std::vector<std::thread> threads;
  for (const std::string& content : contents) {
    threads.emplace_back([&] {
      for (int i = 0; i < 50; ++i) AtomicWrite(root() / "file", content);
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_THAT(ReadFile(root() / "file"), AnyOf(contents[0], contents[1]));
  EXPECT_THAT(Names(root()), ElementsAre("file"));
}

TEST_F(FilesTest, TempDirectoriesAreHiddenDifferentAndRecognised) {
  const fs::path a = MakeTempDirectory(root(), "ep_1"), b = MakeTempDirectory(root(), "ep_1");
  EXPECT_NE(a, b);
  EXPECT_THAT(Names(root()), SizeIs(2));
  EXPECT_THAT(Names(root()), Each(StartsWith(".ep_1.")));
  EXPECT_TRUE(IsTemporaryName(a.filename().native()));
  EXPECT_FALSE(IsTemporaryName("ep_1"));
  EXPECT_FALSE(IsTemporaryName(".hidden"));
  ExpectThrow<IoError>([&] { MakeTempDirectory(root() / "no", "x"); },
                       "cannot create a folder in '" + (root() / "no").native() + "'");
}

// On a shared disk, processes of several machines may have the same number.
TEST_F(FilesTest, SkipsTemporaryNamesInUse) {
  const auto number = [](const fs::path& path) {
    return internal::TemporaryName::Parse(path.filename().native())->number;
  };
  const uint64_t next = number(TemporaryPath(root(), "a")) + 1;
  const auto taken = [](uint64_t n) { return internal::TemporaryName{"a", getpid(), n}.Text(); };
  for (uint64_t n : {next, next + 1}) std::ofstream(root() / taken(n));
  EXPECT_EQ(number(MakeTempDirectory(root(), "a")), next + 2);
  for (uint64_t n : {next + 3, next + 4}) std::ofstream(root() / taken(n));
  const fs::path file = MakeTempFile(root() / "a");
  EXPECT_EQ(number(file), next + 5);
  EXPECT_EQ(ReadFile(file), "");
}

TEST_F(FilesTest, CommitMakesTheWholeFolderAppear) {
  const fs::path work = MakeTempDirectory(root(), "ep_1");
  AtomicWrite(work / "steps.h5", "steps");
  fs::create_directory(work / "extra");
  AtomicWrite(work / "extra" / "note", "note");
  CommitDirectory(work, root() / "ep_1");
  EXPECT_THAT(Names(root()), ElementsAre("ep_1"));
  EXPECT_THAT(Names(root() / "ep_1"), ElementsAre("extra", "steps.h5"));
  EXPECT_EQ(ReadFile(root() / "ep_1/extra/note"), "note");
}

TEST_F(FilesTest, CommitNeverReplacesAnExistingTarget) {
  for (const std::string taken : {"full", "empty", "file", "dangling"}) {
    const fs::path target = root() / taken;
    if (taken == "full") fs::create_directories(target / "x");
    if (taken == "empty") fs::create_directory(target);
    if (taken == "file") AtomicWrite(target, "former");
    if (taken == "dangling") fs::create_symlink("nowhere", target);
    const fs::path work = MakeTempDirectory(root(), "work");
    ExpectThrow<IoError>([&] { CommitDirectory(work, target); },
                         "cannot commit to '" + target.native() + "': File exists");
    EXPECT_TRUE(fs::is_directory(work)) << taken;
  }
  EXPECT_EQ(ReadFile(root() / "file"), "former");
}

TEST_F(FilesTest, CommitRejectsLinksAndPipes) {
  const fs::path work = MakeTempDirectory(root(), "ep_1");
  fs::create_symlink("/etc/passwd", work / "link");
  ExpectThrow<IoError>([&] { CommitDirectory(work, root() / "ep_1"); },
                       "link': it is neither a file nor a folder");
  EXPECT_FALSE(fs::exists(root() / "ep_1"));
}

TEST_F(FilesTest, CommitNamesAMissingFolder) {
  ExpectThrow<IoError>(
      [&] { CommitDirectory(root() / "gone", root() / "ep_1"); },
      "cannot list '" + (root() / "gone").native() + "': No such file or directory");
}

TEST_F(FilesTest, FlushingAMissingFileIsAnError) {
  ExpectThrow<IoError>([&] { FsyncFile(root() / "gone"); }, "cannot flush '");
  AtomicWrite(root() / "file", "x");
  ExpectThrow<IoError>([&] { FsyncDirectory(root() / "file"); }, "Not a directory");
  FsyncFile(root() / "file");
  FsyncDirectory(root());
}

TEST_F(FilesTest, FreeBytesAreThoseOfTheNearestFolder) {
  EXPECT_GT(FreeBytes(root()), 0u);
  EXPECT_GT(FreeBytes(root() / "not" / "yet" / "there"), 0u);
  EXPECT_EQ(FreeBytes("/proc"), 0u);
}

TEST(IoError, SuggestsAKnownRemedy) {
  ExpectThrow<IoError>([] { ThrowIoError("write", "/x", EROFS); },
                       "cannot write '/x': Read-only file system. Choose another place");
  ExpectThrow<IoError>([] { ThrowIoError("read", "/x", EMFILE); }, "raise the limit (ulimit -n)");
  ExpectThrow<IoError>([] { ThrowIoError("write", "/proc/x", EDQUOT); }, "0 bytes are free there.");
}

// A user who may write into a folder but not read it can rename in it, but not flush it.
TEST_F(FilesTest, ReportsThatTheFileExistsAfterALateFailure) {
  const fs::path dataset = root() / "dataset", work = dataset / "work", final = dataset / "episode";
  fs::create_directories(work);
  fs::permissions(root(), fs::perms(0755));
  fs::permissions(work, fs::perms(0777));
  fs::permissions(dataset, fs::perms(0333));
  const std::string message = MessageAsNobody([&] { CommitDirectory(work, final); });
  fs::permissions(dataset, fs::perms(0755));
  EXPECT_THAT(message, StartsWith("'" + final.string() + "' is in place, but a power cut may"));
  EXPECT_THAT(message, HasSubstr("Permission denied"));
  EXPECT_THAT(Names(dataset), ElementsAre("episode"));
}

}  // namespace

namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(FolderNames, AreSortedAndWithoutTheFolder) {
  const TempDir folder;
  for (const char* name : {"b", "a", ".hidden"}) AtomicWrite(folder / name, "");
  EXPECT_THAT(FolderNames(folder.path()), ElementsAre(".hidden", "a", "b"));
  EXPECT_EQ(FolderNamesIfAny(folder.path()), FolderNames(folder.path()));
}

TEST(FolderNames, AreEmptyOrAnIoErrorForAMissingFolder) {
  const TempDir folder;
  AtomicWrite(folder / "file", "");
  for (const char* name : {"missing", "file"}) {
    EXPECT_THAT(FolderNamesIfAny(folder / name), IsEmpty());
    ExpectThrow<IoError>([&] { FolderNames(folder / name); }, "cannot list");
  }
}

}  // namespace
}  // namespace robocell
