#include "robocell/media/warm_program.h"

#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include "robocell/base/files.h"
#include "robocell/media/child_process.h"
#include "robocell/media/ffmpeg.h"
#include "robocell/media/testing/fake_ffmpeg.h"
#include "robocell/media/testing/videos.h"
#include "robocell/testing/long_form.h"
#include "robocell/testing/scoped_env.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

const VideoOptions kTiny{.width = 96, .height = 64, .fps_num = 500, .fps_den = 33};

std::string Printed(ChildProcess& child) {
  std::string text(4096, '\0');
  text.resize(child.Read({reinterpret_cast<uint8_t*>(text.data()), text.size()}));
  return text;
}

std::string OfProcess(pid_t pid, const char* file) {
  std::ifstream in(fs::path("/proc") / std::to_string(pid) / file);
  return {std::istreambuf_iterator<char>(in), {}};
}

bool IsOurs(pid_t pid) {
  return OfProcess(pid, "status").find("PPid:\t" + std::to_string(getpid()) + "\n") !=
         std::string::npos;
}

constexpr ChildProcessOptions kTalking{.pipe_stdout = true, .warm = true};

class WarmProgramTest : public ::testing::Test {
 protected:
  WarmProgramTest() {
    EndWarmPrograms();
    // Nothing of the rest can be tried where ffmpeg is a script or has no loader.
    const ChildProcess child({FindFfmpeg(), "-version"}, kTalking);
    works = WarmProgramPid() > 0;
  }
  ~WarmProgramTest() override { EndWarmPrograms(); }
  bool works = false;
  TempDir folder;
};

#define REQUIRE_WARM \
  if (!works) GTEST_SKIP() << "this machine's ffmpeg cannot wait before its main function"

TEST_F(WarmProgramTest, AStartIsTheProgramsOwn) {
  REQUIRE_WARM;
  ChildProcess warm({FindFfmpeg(), "-hide_banner", "-version"}, kTalking);
  ChildProcess cold({FindFfmpeg(), "-hide_banner", "-version"}, {.pipe_stdout = true});
  EXPECT_EQ(Printed(warm), Printed(cold));
  EXPECT_EQ(warm.Wait(), 0);
  EXPECT_THAT(OfProcess(WarmProgramPid(), "cmdline"), HasSubstr("ffmpeg"));
}

TEST_F(WarmProgramTest, ManyVideosAreStartedByOneProcessAndHaveTheBytesOfColdStarts) {
  REQUIRE_WARM;
  const pid_t waiting = WarmProgramPid();
  {
    const ScopedEnv cold("ROBOCELL_WARM_FFMPEG", "0");
    WriteVideo(folder / "cold.mp4", 20, kTiny);
  }
  for (int i = 0; i < 5; ++i) {
    WriteVideo(folder / "warm.mp4", 20, kTiny);
    EXPECT_EQ(ReadFile(folder / "warm.mp4"), ReadFile(folder / "cold.mp4")) << "video " << i;
  }
  EXPECT_EQ(WarmProgramPid(), waiting);
}

TEST_F(WarmProgramTest, EncodersAreChildrenInSeparateProcessGroups) {
  REQUIRE_WARM;
  const VideoWriter video(folder / "a.mp4", kTiny);
  EXPECT_THAT(OfProcess(video.encoder_pid(), "status"),
              HasSubstr("PPid:\t" + std::to_string(getpid())));
  EXPECT_EQ(getpgid(video.encoder_pid()), video.encoder_pid());
  EXPECT_NE(video.encoder_pid(), WarmProgramPid());
}

TEST_F(WarmProgramTest, ItsArgumentsAreShownToTheMachine) {
  REQUIRE_WARM;
  const VideoWriter video(folder / "a.mp4", kTiny);
  std::string shown;
  for (int i = 0; i < 10000 && shown.find("libx264") == std::string::npos; ++i) {
    shown = OfProcess(video.encoder_pid(), "cmdline");
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  EXPECT_THAT(shown, HasSubstr("libx264"));
}

TEST_F(WarmProgramTest, ReplacesAKilledProgram) {
  REQUIRE_WARM;
  const pid_t first = WarmProgramPid();
  kill(first, SIGKILL);
  WriteVideo(folder / "a.mp4", 5, kTiny);
  EXPECT_GT(WarmProgramPid(), 0);
  EXPECT_NE(WarmProgramPid(), first);
}

TEST_F(WarmProgramTest, VideosAreCompleteDespiteKills) {
  REQUIRE_WARM;
  WriteVideo(folder / "calm.mp4", 5, kTiny);
  std::atomic<bool> is_over = false;
  std::thread killer([&] {
    for (int pause = 0; !is_over; pause = (pause + 1) % 7) {
      const pid_t waiting = WarmProgramPid();
      std::this_thread::sleep_for(std::chrono::milliseconds(pause));
      if (waiting > 0 && IsOurs(waiting)) kill(waiting, SIGKILL);
      std::this_thread::sleep_for(std::chrono::milliseconds(40));
    }
  });
  const int videos = LongForm() ? 30 : 10;
  for (int i = 0; i < videos; ++i) {
    WriteVideo(folder / "a.mp4", 5, kTiny);
    EXPECT_EQ(ReadFile(folder / "a.mp4"), ReadFile(folder / "calm.mp4")) << "video " << i;
  }
  is_over = true;
  killer.join();
}

TEST_F(WarmProgramTest, ADeadEncoderDoesNotAffectOthers) {
  REQUIRE_WARM;
  VideoWriter dying(folder / "dying.mp4", kTiny), other(folder / "other.mp4", kTiny);
  kill(dying.encoder_pid(), SIGKILL);
  for (int i = 0; i < 10; ++i) other.Write(TestFrame(96, 64, i));
  other.Finish();
  EXPECT_EQ(ReadVideoInfo(folder / "other.mp4").frames, 10);
}

TEST_F(WarmProgramTest, TheWorkingFolderTheEnvironmentAndTheLimitsArePresentOnes) {
  REQUIRE_WARM;
  const fs::path before = fs::current_path();
  fs::current_path(folder.path());
  WriteVideo("here.mp4", 3, kTiny);
  fs::current_path(before);
  EXPECT_TRUE(fs::exists(folder / "here.mp4"));
  const pid_t first = WarmProgramPid();
  {
    const ScopedEnv changed("ROBOCELL_TEST_CHANGE", "1");
    const VideoWriter video(folder / "b.mp4", kTiny);
    EXPECT_THAT(OfProcess(video.encoder_pid(), "environ"), HasSubstr("ROBOCELL_TEST_CHANGE=1"));
    EXPECT_NE(WarmProgramPid(), first);
  }
  rlimit limit = {};
  getrlimit(RLIMIT_NOFILE, &limit);
  const rlimit less{limit.rlim_cur - 1, limit.rlim_max};
  setrlimit(RLIMIT_NOFILE, &less);
  const VideoWriter video(folder / "c.mp4", kTiny);
  EXPECT_THAT(OfProcess(video.encoder_pid(), "limits"), HasSubstr(std::to_string(less.rlim_cur)));
  setrlimit(RLIMIT_NOFILE, &limit);
}

TEST_F(WarmProgramTest, AForkStartsItsOwn) {
  REQUIRE_WARM;
  const pid_t ours = WarmProgramPid();
  EXPECT_EQ(InOwnProcess([&] {
              WriteVideo(folder / "a.mp4", 5, kTiny);
              const bool own = WarmProgramPid() > 0 && WarmProgramPid() != ours;
              EndWarmPrograms();
              return own ? 0 : 1;
            }),
            0);
  EXPECT_EQ(WarmProgramPid(), ours);
  EXPECT_EQ(kill(ours, 0), 0);
}

TEST_F(WarmProgramTest, ItEndsWithItsProcess) {
  REQUIRE_WARM;
  EndWarmPrograms();
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const pid_t child = fork();
  if (child == 0) {
    WriteVideo(folder / "a.mp4", 2, kTiny);
    const pid_t waiting = WarmProgramPid();
    _exit(write(ends[1], &waiting, sizeof waiting) == sizeof waiting ? 0 : 1);
  }
  pid_t waiting = 0;
  ASSERT_EQ(read(ends[0], &waiting, sizeof waiting), static_cast<ssize_t>(sizeof waiting));
  waitpid(child, nullptr, 0);
  bool ended = false;
  for (int i = 0; i < 5000 && !ended; ++i) {
    ended = OfProcess(waiting, "cmdline").empty();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_TRUE(ended);
  close(ends[0]);
  close(ends[1]);
}

TEST_F(WarmProgramTest, ScriptsAndProgramsThatAreSwitchedOffStartAsUsual) {
  {
    const FakeFfmpeg script("echo 'a script'");
    ChildProcess child({FindFfmpeg()}, kTalking);
    EXPECT_EQ(Printed(child), "a script\n");
    EXPECT_EQ(WarmProgramPid(), -1);
  }
  EndWarmPrograms();
  const ScopedEnv off("ROBOCELL_WARM_FFMPEG", "0");
  WriteVideo(folder / "a.mp4", 2, kTiny);
  EXPECT_EQ(WarmProgramPid(), -1);
}

TEST_F(WarmProgramTest, ThreadsCanStartConcurrently) {
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&, i] {
      for (int k = 0; k < 3; ++k)
        WriteVideo(folder / (std::to_string(10 * i + k) + ".mp4"), 3, kTiny);
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 12);
  ExpectNoChildLeft();
}

TEST_F(WarmProgramTest, ItTakesMuchLessTimeThanAColdStart) {
  REQUIRE_WARM;
  const auto cpu = [&](const char* warm) {
    const ScopedEnv env("ROBOCELL_WARM_FFMPEG", warm);
    ChildProcess({FindFfmpeg(), "-version"}, kTalking).Wait();  // whatever has to be loaded
    rusage before = {}, after = {};
    getrusage(RUSAGE_CHILDREN, &before);
    for (int i = 0; i < 5; ++i) ChildProcess({FindFfmpeg(), "-version"}, kTalking).Wait();
    getrusage(RUSAGE_CHILDREN, &after);
    const auto seconds = [](const timeval& t) { return t.tv_sec + 1e-6 * t.tv_usec; };
    return seconds(after.ru_utime) + seconds(after.ru_stime) - seconds(before.ru_utime) -
           seconds(before.ru_stime);
  };
  const double cold = cpu("0"), warm = cpu("1");
  EXPECT_LT(warm, 0.5 * cold);
}

}  // namespace
}  // namespace robocell::internal
