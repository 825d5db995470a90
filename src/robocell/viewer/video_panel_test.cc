#include "robocell/viewer/video_panel.h"

#include <gtest/gtest.h>

#include <filesystem>
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

TEST_F(Viewers, AJumpOfTimeIsOnePicture) {
  TempDir folder;
  Viewer viewer = Viewer::Open(scene_, kInMemory);
  viewer.set_realtime_factor(0);
  const std::string path = folder / "a.mp4";
  viewer.StartRecording(path, 50, {64, 48}, "side");
  for (int i = 0; i < 10; ++i) viewer.Step();
  scene_.data()->time = 1e6;
  for (int i = 0; i < 30; ++i) viewer.Step();
  scene_.data()->time = 3;
  for (int i = 0; i < 10; ++i) viewer.Step();
  viewer.StopRecording();
  EXPECT_LT(ReadVideoInfo(path).frames, 10);
}

TEST_F(Viewers, ThePanelRecordsIntoFilesOfTheirOwn) {
  TempDir folder;
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  Viewer viewer = Viewer::Open(scene_, kInMemory);
  viewer.set_realtime_factor(0);
  viewer.ShowPanels("Recorder", "");
  for (const char* file : {"recording.mp4", "recording_001.mp4", "recording_002.mp4"}) {
    Click(viewer, "Recorder", "Start");
    EXPECT_TRUE(viewer.recording());
    for (int i = 0; i < 40; ++i) viewer.Step();
    Click(viewer, "Recorder", "Stop");
    EXPECT_FALSE(viewer.recording());
    EXPECT_GT(ReadVideoInfo(file).frames, 0) << file;
  }
  std::filesystem::current_path(before);
}

}  // namespace
}  // namespace robocell
