// Tests segmentation of a camera: stored to the last bit, with labels that name its numbers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <vector>
#include <nlohmann/json.hpp>

#include "robocell/base/checked_json.h"
#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/data/episode_reader.h"
#include "robocell/data/episode_writer.h"
#include "robocell/data/verify.h"
#include "robocell/media/testing/frames.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kWide = 64, kHigh = 48;

const std::vector<SegmentLabel> kLabels = {
    {"world", ""}, {"arm/link1", "robots/arm"}, {"cube", "objects/cube"}};

// Returns labels with a moving border between a labelled region and the rest.
std::vector<uint16_t> TestLabels(int row) {
  std::vector<uint16_t> labels(static_cast<size_t>(kWide) * kHigh);
  for (size_t i = 0; i < labels.size(); ++i) {
    const int column = static_cast<int>(i) % kWide;
    labels[i] = column < row ? kNoSegment : static_cast<uint16_t>((column / 7) % 3);
  }
  return labels;
}

class Segmentation : public ::testing::Test {
 protected:
  Segmentation() {
    time = schema.AddColumn({.name = "time", .units = "s"});
    eye = schema.AddCamera({.name = "eye", .width = kWide, .height = kHigh, .segmentation = true});
    other = schema.AddCamera({.name = "other", .width = kWide, .height = kHigh});
    schema.SetSegmentLabels(kLabels);
  }

  void PutRow(EpisodeWriter& episode, int row) const {
    episode.Put(time, 0.1 * row);
    episode.EndRow();
    for (const CameraId camera : {eye, other})
      episode.WriteFrame(camera, TestFrame(kWide, kHigh, row));
  }
  std::filesystem::path Write(const std::string& id, int rows = 12) const {
    EpisodeWriter episode(folder.path(), id, schema);
    for (int row = 0; row < rows; ++row) {
      PutRow(episode, row);
      episode.WriteSegmentation(eye, TestLabels(row));
    }
    return episode.Commit({.success = true});
  }

  TempDir folder;
  EpisodeSchema schema;
  ColumnId time;
  CameraId eye, other;
};

TEST_F(Segmentation, RoundTripsBitwise) {
  const Episode episode(Write("a"));
  VideoReader video = episode.SegmentationVideo("eye");
  EXPECT_EQ(video.info().frames, 12);
  std::vector<uint16_t> labels(static_cast<size_t>(kWide) * kHigh);
  for (const int row : {9, 0, 11, 4}) {
    video.Read(row, labels);
    EXPECT_EQ(labels, TestLabels(row)) << row;
  }
  EXPECT_EQ(episode.segment_labels(), kLabels);
}

TEST_F(Segmentation, IsDescribedInTheEpisode) {
  const auto json = nlohmann::json::parse(Episode(Write("a")).json());
  EXPECT_EQ(json["cameras"]["eye"]["segmentation"],
            nlohmann::json({{"file", "eye.segmentation.mov"}, {"frames", 12}}));
  EXPECT_FALSE(json["cameras"]["other"].contains("segmentation"));
  EXPECT_EQ(json["segmentation"]["none"], 65535);
  EXPECT_EQ(json["segmentation"]["labels"][2],
            nlohmann::json({{"name", "cube"}, {"owner", "objects/cube"}}));
  EXPECT_TRUE(json["files"].contains("eye.segmentation.mov"));
}

TEST_F(Segmentation, HasTheSameBytesEveryTime) {
  EXPECT_EQ(ReadFile(Write("a") / "eye.segmentation.mov"),
            ReadFile(Write("b") / "eye.segmentation.mov"));
}

TEST_F(Segmentation, IsRequiredInEveryRow) {
  EpisodeWriter episode(folder.path(), "a", schema);
  PutRow(episode, 0);
  ExpectThrow<ArgumentError>([&] { episode.Commit({}); },
                             "camera 'eye' has 0 segmentation frames for the 1 row of");
  episode.WriteSegmentation(eye, TestLabels(0));
  EXPECT_EQ(episode.segmentation_frames(eye), 1);
  episode.Commit({});
}

TEST_F(Segmentation, RejectsNumbersWithoutALabel) {
  EpisodeWriter episode(folder.path(), "a", schema);
  std::vector<uint16_t> labels = TestLabels(0);
  labels[100] = 3;
  ExpectThrow<ArgumentError>(
      [&] { episode.WriteSegmentation(eye, labels); },
      "a pixel of segmentation is 3, of the 3 labels 0 ... 2; 65535 is for what has none");
  ExpectThrow<ArgumentError>([&] { episode.WriteSegmentation(other, TestLabels(0)); },
                             "camera 'other' was declared without segmentation");
}

TEST_F(Segmentation, NeedsLabels) {
  EpisodeSchema without;
  without.AddColumn({.name = "time", .units = "s"});
  without.AddCamera({.name = "eye", .width = kWide, .height = kHigh, .segmentation = true});
  ExpectThrow<ArgumentError>([&] { EpisodeWriter(folder.path(), "a", without); },
                             "a camera has segmentation, so the schema needs labels");
  ExpectThrow<ArgumentError>([&] { without.SetSegmentLabels({}); }, "0 labels are declared");
  ExpectThrow<ArgumentError>(
      [&] { without.SetSegmentLabels(std::vector<SegmentLabel>(size_t{65536})); },
      "its images hold 1 to 65535 of them");
}

TEST_F(Segmentation, NamesACameraWithoutSegmentation) {
  const Episode episode(Write("a"));
  ExpectThrow<NotFoundError>([&] { episode.SegmentationVideo("other"); },
                             "camera 'other' has no segmentation. Cameras with segmentation: eye");
}

TEST_F(Segmentation, IsVerified) {
  const std::filesystem::path episode = Write("a");
  EXPECT_THAT(Verify(folder.path(), {.decode_videos = true}).problems, IsEmpty());
  AtomicWrite(episode / "eye.segmentation.mov", "no video");
  const VerifyResult result = Verify(folder.path());
  EXPECT_THAT(result.bad, ElementsAre("a"));
  EXPECT_THAT(result.Text(), HasSubstr("a/eye.segmentation.mov: it is cut short"));
}

TEST_F(Segmentation, WithATruncatedTableIsDamaged) {
  const std::filesystem::path file = Write("a") / "episode.json";
  auto json = nlohmann::ordered_json::parse(ReadFile(file));
  json["segmentation"]["labels"].erase(2);
  json["run"]["json_sha256"] = kHashPlaceholder;
  AtomicWrite(file, InsertSelfHash(json.dump(2) + "\n"));
  EXPECT_THAT(Verify(folder.path(), {.decode_videos = true}).Text(),
              HasSubstr("a pixel of it is 2, and episode.json has 2 labels"));
}

// Readers treat 65535 as unlabelled: an episode with another number must be rejected.
TEST_F(Segmentation, RejectsAnotherBackgroundNumber) {
  const std::filesystem::path file = Write("a") / "episode.json";
  const auto original = nlohmann::ordered_json::parse(ReadFile(file));
  for (const nlohmann::ordered_json& none :
       std::initializer_list<nlohmann::ordered_json>{5, -1, "x", nullptr, {{"labels", 5}}}) {
    auto json = original;
    json["segmentation"]["none"] = none;
    json["run"]["json_sha256"] = kHashPlaceholder;
    AtomicWrite(file, InsertSelfHash(json.dump(2) + "\n"));
    ExpectThrow<IoError>([&] { Episode(file.parent_path()); }, "episode.json is damaged");
  }
}

}  // namespace
}  // namespace robocell
