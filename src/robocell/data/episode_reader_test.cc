#include "robocell/data/episode_reader.h"

#include <sys/wait.h>
#include <unistd.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>
#include <nlohmann/json.hpp>

#include "robocell/base/checked_json.h"
#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/data/testing/sample_episode.h"
#include "robocell/media/testing/videos.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(Episode, ListsItsContents) {
  TempDir folder;
  const Episode episode(SampleEpisode().Write(folder.path(), "a"));
  EXPECT_THAT(episode.tables(), ElementsAre("steps", "control"));
  EXPECT_THAT(episode.files(), ElementsAre("steps.h5", "wrist.mp4", "scene.mjb"));
  std::vector<std::string> names;
  for (const ColumnInfo& column : episode.columns()) names.push_back(column.spec.name);
  EXPECT_THAT(names, ElementsAre("cameras/wrist/intrinsics", "control/ctrl", "control/time",
                                 "image_mean", "objects/cube/pose", "phase", "reward",
                                 "robots/arm/qpos", "success", "time"));
  EXPECT_EQ(episode.camera("wrist").fps_num, 500);
  EXPECT_EQ(episode.camera("wrist").table, "steps");
}

TEST(Episode, SuggestsTheNearestName) {
  TempDir folder;
  const Episode episode(SampleEpisode().Write(folder.path(), "a"));
  ExpectThrow<NotFoundError>([&] { episode.Read<double>("rewrad"); }, "Did you mean 'reward'?");
  ExpectThrow<NotFoundError>([&] { episode.Video("wirst"); }, "Did you mean 'wrist'?");
  ExpectThrow<NotFoundError>([&] { episode.rows("ctrl"); }, "no table 'ctrl'");
}

TEST(Episode, RejectsRowsBeyondTheEndAndOtherTypes) {
  TempDir folder;
  const Episode episode(SampleEpisode().Write(folder.path(), "a", 20));
  ExpectThrow<ArgumentError>([&] { episode.Read<double>("reward", {.first = 18, .count = 3}); },
                             "rows 18 ... 20 of 'reward' were requested, it has 20");
  ExpectThrow<ArgumentError>([&] { episode.Read<double>("reward", {.first = -1}); }, "it has 20");
  ExpectThrow<ArgumentError>([&] { episode.Read<double>("phase"); },
                             "column 'phase' holds int32, it cannot be read as float64");
  EXPECT_TRUE(episode.Read<double>("reward", {.first = 20}).empty());
}

TEST(Episode, NamesAFolderThatIsNotAnEpisode) {
  TempDir folder;
  ExpectThrow<IoError>([&] { Episode(folder / "none"); }, (folder / "none").string());
  SampleEpisode(0, false).Write(folder.path(), "a");
  AtomicWrite(folder / "a" / "episode.json", "{\"format\": \"robocell-ep");
  ExpectThrow<IoError>(
      [&] { Episode(folder / "a"); },
      "a': episode.json is damaged: it is cut short: its text ends after 23 bytes, "
      "in the middle. `robocell verify " +
          folder.path().string() + "` names all that is damaged, `robocell verify --repair " +
          folder.path().string() + "` sets it aside");
  AtomicWrite(folder / "a" / "episode.json", R"({"format": "robocell-episode"})");
  ExpectThrow<IoError>([&] { Episode(folder / "a"); },
                       "episode.json is damaged: it carries no hash of itself");
  AtomicWrite(folder / "a" / "episode.json",
              R"({"format": "robocell-episode", "format_version": 99})");
  ExpectThrow<IoError>([&] { Episode(folder / "a"); },
                       "format version 99 is not 1, which this robocell reads");
}

TEST(Episode, InvalidNumbersInADescriptionAreDamage) {
  TempDir folder;
  const fs::path file = SampleEpisode().Write(folder.path(), "a") / "episode.json";
  const auto good = nlohmann::ordered_json::parse(ReadFile(file));
  for (const char* at : {"/files/steps.h5/bytes", "/cameras/wrist/width", "/cameras/wrist/fps/0"}) {
    auto bad = good;
    bad[nlohmann::json::json_pointer(at)] = 5.3e81;
    bad["run"][kJsonHash] = kHashPlaceholder;
    AtomicWrite(file, InsertSelfHash(bad.dump(2)));
    ExpectThrow<IoError>([&] { Episode episode(folder / "a"); },
                         "episode.json is damaged: its hash is right, but it does not describe");
  }
}

// The HDF5 library ends the process on some of them.
TEST(Episode, ChangedBytesNeverReachTheirReaders) {
  const TempDir folder;
  SampleEpisode(1, false).Write(folder.path(), "a", 3);
  const auto flip = [&](const char* file, size_t at) {
    std::string bytes = ReadFile(folder / "a" / file);
    bytes[at] ^= 1;
    AtomicWrite(folder / "a" / file, bytes);
  };
  flip("steps.h5", 100);
  const Episode episode(folder / "a");
  const std::string text = ExpectThrow<IoError>([&] { episode.Read<double>("time"); },
                                                "'steps.h5' is damaged: its hash does not match");
  EXPECT_THAT(text, HasSubstr("`robocell verify --repair "));
  const size_t digit = ReadFile(folder / "a" / "episode.json").find("\"rows\": 3") + 8;
  flip("episode.json", digit);  // another number of rows, and still JSON
  ExpectThrow<IoError>([&] { Episode(folder / "a"); },
                       "episode.json is damaged: its hash does not match its text");
}

TEST(Episode, NamesAMissingOrShortFileAtOpen) {
  TempDir folder;
  const fs::path path = SampleEpisode().Write(folder.path(), "a");
  fs::resize_file(path / "wrist.mp4", 100);
  ExpectThrow<IoError>([&] { Episode episode(path); }, "'wrist.mp4' has 100 bytes");
  fs::remove(path / "wrist.mp4");
  ExpectThrow<IoError>([&] { Episode episode(path); }, "'wrist.mp4': No such file or directory");
}

TEST(Episode, ReadsFramesInAnyOrder) {
  TempDir folder;
  const SampleEpisode sample(3, true, true);
  const Episode episode(sample.Write(folder.path(), "a", 12));
  std::vector<uint8_t> rgb(size_t{3} * sample.width * sample.height), expected(rgb.size());
  std::vector<uint16_t> depth(size_t{1} * sample.width * sample.height);
  for (const int64_t i : {5, 6, 7, 0, 11, 3, 4}) {
    VideoReader video = episode.Video("wrist");
    video.Read(i, expected);
    episode.ReadFrame("wrist", ImageKind::kColour, i, rgb);
    EXPECT_EQ(rgb, expected) << i;
    episode.ReadFrame("wrist", ImageKind::kDepth, i, depth);
    EXPECT_EQ(depth, TestDepth(sample.width, sample.height, static_cast<int>(i) + 3)) << i;
  }
  ReleaseIdleFiles();
  ExpectNoChildLeft();
}

TEST(Episode, RejectsMissingFrames) {
  TempDir folder;
  const SampleEpisode sample(3, true, false);
  const Episode episode(sample.Write(folder.path(), "a", 12));
  std::vector<uint8_t> rgb(size_t{3} * sample.width * sample.height);
  const auto read = [&](const char* camera, ImageKind kind, int64_t index) {
    episode.ReadFrame(camera, kind, index, rgb);
  };
  for (const int64_t index : {-1, 12})
    ExpectThrow<ArgumentError>([&] { read("wrist", ImageKind::kColour, index); },
                               "of 'wrist'. It has 12 frames: 0 ... 11");
  ExpectThrow<NotFoundError>([&] { read("wirst", ImageKind::kColour, 0); }, "mean 'wrist'?");
  ExpectThrow<NotFoundError>([&] { read("wrist", ImageKind::kDepth, 0); },
                             "camera 'wrist' has no depth. Cameras with depth: none");
  rgb.pop_back();
  ExpectThrow<ArgumentError>([&] { read("wrist", ImageKind::kColour, 0); }, "expected a buffer of");
}

TEST(Episode, StreamsHaveTheNamesOfTheirFiles) {
  TempDir folder;
  const Episode episode(SampleEpisode(0, true, true).Write(folder.path(), "a", 2));
  const std::vector<ImageStream> streams = episode.streams();
  ASSERT_EQ(streams.size(), 2u);
  EXPECT_EQ(streams[0].name, "wrist");
  EXPECT_EQ(streams[1].name, "wrist.depth");
  EXPECT_EQ(episode.stream("wrist.depth").kind, ImageKind::kDepth);
  EXPECT_EQ(episode.stream("wrist.depth").camera, "wrist");
  ExpectThrow<NotFoundError>([&] { episode.stream("wrist.deepth"); },
                             "Its image streams: wrist, wrist.depth. Did you mean 'wrist.depth'?");
}

// The camera is slower than the rows: its frames are rows of a table of its own.
TEST(Episode, RowsOfOtherTablesFindFramesByTime) {
  TempDir folder;
  EpisodeSchema schema;
  const ColumnId time = schema.AddColumn({.name = "time", .units = "s"});
  const TableId images = schema.AddTable("images");
  const ColumnId image_time = schema.AddColumn({.name = "time", .units = "s"}, images);
  const TableId timeless = schema.AddTable("timeless");
  const ColumnId count = schema.AddColumn({.name = "count"}, timeless);
  const CameraId slow = schema.AddCamera({.name = "slow", .width = 32, .height = 16}, images);
  EpisodeWriter writer(folder.path(), "a", schema);
  for (int i = 0; i < 10; ++i) {
    writer.Put(time, 0.1 * i);
    writer.EndRow();
  }
  for (int i = 0; i < 3; ++i) {
    writer.Put(image_time, 0.1 + 3 * 0.1 * i);  // of rows 1, 4 and 7, with another rounding
    writer.EndRow(images);
    writer.WriteFrame(slow, TestFrame(32, 16, i));
  }
  writer.Put(count, 1.0);
  writer.EndRow(timeless);
  const Episode episode(writer.Commit({.success = true, .terminated = true, .end_reason = "end"}));
  EXPECT_THAT(episode.FramesOfRows("slow"), ElementsAre(-1, 0, 0, 0, 1, 1, 1, 2, 2, 2));
  EXPECT_THAT(episode.FramesOfRows("slow", "images"), ElementsAre(0, 1, 2));
  ExpectThrow<ArgumentError>([&] { episode.FramesOfRows("slow", "timeless"); },
                             "not known without a column 'timeless/time'");
  ExpectThrow<NotFoundError>([&] { episode.FramesOfRows("slow", "image"); }, "mean 'images'?");
}

int64_t OpenDescriptors() {
  return std::distance(fs::directory_iterator("/proc/self/fd"), fs::directory_iterator());
}

TEST(Episode, ManyEpisodesKeepFewFilesOpen) {
  TempDir folder;
  SampleEpisode(0, false).Write(folder.path(), "a", 2);
  std::vector<Episode> all;
  ReleaseIdleFiles();  // closes those of other tests
  const int64_t before = OpenDescriptors();
  for (int i = 0; i < 100; ++i) {
    const fs::path own = folder / ("copy" + std::to_string(i)) / "a";
    fs::create_directories(own.parent_path());
    fs::copy(folder / "a", own, fs::copy_options::recursive);
    all.emplace_back(own);
    EXPECT_EQ(all.back().Read<double>("time").size(), 2u);
  }
  EXPECT_LT(OpenDescriptors() - before, 40);
  for (const Episode& episode : all) EXPECT_EQ(episode.Read<double>("reward").size(), 2u);
  EXPECT_LT(OpenDescriptors() - before, 40);
  ReleaseIdleFiles();
  EXPECT_EQ(OpenDescriptors(), before);
}

TEST(Episode, DetectsDamageAfterTheFirstRead) {
  TempDir folder;
  const Episode episode(SampleEpisode(0, false).Write(folder.path(), "a", 2));
  EXPECT_EQ(episode.Read<double>("time").size(), 2u);
  std::string bytes = ReadFile(folder / "a" / "steps.h5");
  bytes[bytes.size() / 2] ^= 1;
  AtomicWrite(folder / "a" / "steps.h5", bytes);
  ExpectThrow<IoError>([&] { episode.Read<double>("time"); }, "its hash does not match");
}

TEST(Episode, AnOverwrittenFileIsReadAgain) {
  TempDir folder;
  const fs::path path = SampleEpisode(0, false).Write(folder.path(), "a", 2);
  EXPECT_EQ(Episode(path).Read<double>("time").size(), 2u);
  fs::create_directory(folder / "other");
  SampleEpisode(0, false).Write(folder / "other", "a", 9);
  for (const char* file : {"steps.h5", "episode.json"}) {
    std::ofstream(path / file, std::ios::binary | std::ios::trunc)
        << ReadFile(folder / "other" / "a" / file);
  }
  const Episode longer(path);
  EXPECT_EQ(longer.Read<double>("time").size(), 9u);
  EXPECT_EQ(longer.Read<double>("time").back(), 0.066 * 8);
}

TEST(Episode, AForkedChildContinuesReading) {
  TempDir folder;
  const SampleEpisode sample(0, true);
  const Episode episode(sample.Write(folder.path(), "a", 12));
  std::vector<uint8_t> rgb(size_t{3} * sample.width * sample.height);
  episode.Read<double>("time");
  episode.ReadFrame("wrist", ImageKind::kColour, 3, rgb);
  const pid_t child = fork();
  std::vector<uint8_t> next(rgb.size()), expected(rgb.size());
  episode.ReadFrame("wrist", ImageKind::kColour, 4, next);
  VideoReader video = episode.Video("wrist");
  video.Read(4, expected);
  const bool well = next == expected && episode.Read<double>("reward").size() == 12;
  if (child == 0) {
    ReleaseIdleFiles();
    _exit(well ? 0 : 1);
  }
  EXPECT_TRUE(well);
  int status = 1;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
}

}  // namespace
}  // namespace robocell
