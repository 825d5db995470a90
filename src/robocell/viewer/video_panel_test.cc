#include "robocell/viewer/video_panel.h"

#include <gtest/gtest.h>

#include <string>

#include "robocell/base/error.h"
#include "robocell/media/video_info.h"
#include "robocell/testing/temp_dir.h"
#include "robocell/viewer/testing/users.h"

namespace robocell {
namespace {

TEST_F(Viewers, RecordsOnePictureForEachPartOfASecond) {
  TempDir folder;
  Viewer viewer = Viewer::Open(scene_, kInMemory);
  viewer.set_realtime_factor(0);
  const std::string path = folder / "a.mp4";
  viewer.StartRecording(path, 50, {64, 48}, "side");
  EXPECT_THROW(viewer.StartRecording(path), Error);
  for (int i = 0; i < 50; ++i) viewer.Step();  // 0.1 s
  EXPECT_EQ(viewer.StopRecording(), path);
  EXPECT_NEAR(ReadVideoInfo(path).frames, 5, 1);
  EXPECT_FALSE(viewer.recording());
}

}  // namespace
}  // namespace robocell
