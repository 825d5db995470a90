#include "robocell/media/video_info.h"

#include <gtest/gtest.h>

#include <fstream>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/media/testing/videos.h"
#include "robocell/media/video_writer.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/skip.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

std::string Answer(const std::string& command) {
  FILE* pipe = popen(command.c_str(), "r");
  char text[200] = "";
  const bool got = fgets(text, sizeof text, pipe) != nullptr;
  pclose(pipe);
  return got ? text : "";
}

TEST(VideoInfo, AgreesWithFfprobe) {
  if (Answer("command -v ffprobe").empty()) SKIP_OR_FAIL("ffprobe is not installed");
  TempDir folder;
  for (const auto& [num, den] : {std::pair{30, 1}, {30000, 1001}, {500, 33}, {1, 3}}) {
    VideoOptions options{.width = 64, .height = 48, .fps_num = num, .fps_den = den};
    WriteVideo(folder / "a.mp4", 7, options);
    const VideoInfo info = ReadVideoInfo(folder / "a.mp4");
    const std::string probed = Answer(
        "ffprobe -v error -count_frames -show_entries "
        "stream=width,height,r_frame_rate,nb_read_frames -of csv=p=0 " +
        (folder / "a.mp4").string());
    EXPECT_EQ(probed, std::to_string(info.width) + "," + std::to_string(info.height) + "," +
                          std::to_string(info.fps_num) + "/" + std::to_string(info.fps_den) + "," +
                          std::to_string(info.frames) + "\n");
    EXPECT_TRUE(info.constant_rate);
  }
}

TEST(VideoInfo, RejectsOtherFilesWithTheReason) {
  TempDir folder;
  Store(folder / "a.mp4", "");
  ExpectThrow<IoError>([&] { ReadVideoInfo(folder / "a.mp4"); }, "it is empty");
  Store(folder / "a.mp4", "this is a text, not a video, and long enough");
  ExpectThrow<IoError>([&] { ReadVideoInfo(folder / "a.mp4"); },
                       "it does not begin like an mp4 file");
  ExpectThrow<IoError>([] { ReadVideoInfo("/dev/zero"); }, "'/dev/zero': it is a device");
}

}  // namespace
}  // namespace robocell
