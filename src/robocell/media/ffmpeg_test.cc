#include "robocell/media/ffmpeg.h"

#include <signal.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "robocell/base/error.h"
#include "robocell/media/testing/fake_ffmpeg.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(Ffmpeg, TheVersionIsItsFirstLine) {
  EXPECT_THAT(FfmpegVersion(), StartsWith("ffmpeg version "));
}

std::string TextOf(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

TEST(Ffmpeg, ReusesTheVersionQueriedByAParent) {
  TempDir folder;
  const fs::path calls = folder / "asked", answer = folder / "answer";
  const std::string count = "echo once >> " + calls.string() + "; echo 'ffmpeg version ";
  {
    const FakeFfmpeg fake(count + "1 Copyright nobody'");
    EXPECT_EQ(InOwnProcess([&] {  // this process has no result yet
                FfmpegVersion();
                std::ofstream(answer) << FfmpegAnswer();
                return FfmpegVersion() == "ffmpeg version 1" ? 0 : 1;
              }),
              0);
    setenv("ROBOCELL_FFMPEG_ANSWER", TextOf(answer).c_str(), 1);
    EXPECT_EQ(FfmpegVersion(), "ffmpeg version 1");
    EXPECT_EQ(FfmpegAnswer(), TextOf(answer));
    EXPECT_EQ(TextOf(calls), "once\n");
  }
  const FakeFfmpeg other(count + "2 Copyright nobody'");
  EXPECT_EQ(FfmpegVersion(), "ffmpeg version 2");
  EXPECT_NE(FfmpegAnswer(), TextOf(answer));
  EXPECT_EQ(TextOf(calls), "once\nonce\n");
  unsetenv("ROBOCELL_FFMPEG_ANSWER");
}

TEST(Ffmpeg, ExplainsAWrongOrMissingExecutable) {
  setenv("ROBOCELL_FFMPEG", "/no/ffmpeg", 1);
  ExpectThrow<IoError>([] { FindFfmpeg(); },
                       "ROBOCELL_FFMPEG is '/no/ffmpeg', which is not an executable file");
  unsetenv("ROBOCELL_FFMPEG");
  const std::string path = getenv("PATH");
  setenv("PATH", "/nowhere", 1);
  ExpectThrow<IoError>([] { FindFfmpeg(); }, "apt install ffmpeg");
  setenv("IMAGEIO_FFMPEG_EXE", "/bin/true", 1);
  EXPECT_EQ(FindFfmpeg(), "/bin/true");
  ExpectThrow<IoError>([] { FfmpegVersion("/bin/true"); }, "is not ffmpeg");
  unsetenv("IMAGEIO_FFMPEG_EXE");
  setenv("PATH", path.c_str(), 1);
}

}  // namespace
}  // namespace robocell
