#include "robocell/data/episode_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/data/signed_json.h"
#include "robocell/data/testing/sample_episode.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(Episode, ItListsWhatItHolds) {
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

TEST(Episode, WhatItDoesNotHoldGetsASuggestion) {
  TempDir folder;
  const Episode episode(SampleEpisode().Write(folder.path(), "a"));
  ExpectThrow<NotFoundError>([&] { episode.Read<double>("rewrad"); }, "Did you mean 'reward'?");
  ExpectThrow<NotFoundError>([&] { episode.Video("wirst"); }, "Did you mean 'wrist'?");
  ExpectThrow<NotFoundError>([&] { episode.rows("ctrl"); }, "no table 'ctrl'");
}

TEST(Episode, RowsBeyondTheEndAndOtherTypesAreRefused) {
  TempDir folder;
  const Episode episode(SampleEpisode().Write(folder.path(), "a", 20));
  ExpectThrow<ArgumentError>([&] { episode.Read<double>("reward", {.first = 18, .count = 3}); },
                             "rows 18 ... 20 of 'reward' were asked for, it has 20");
  ExpectThrow<ArgumentError>([&] { episode.Read<double>("reward", {.first = -1}); }, "it has 20");
  ExpectThrow<ArgumentError>([&] { episode.Read<double>("phase"); },
                             "column 'phase' holds int32, it cannot be read as float64");
  EXPECT_TRUE(episode.Read<double>("reward", {.first = 20}).empty());
}

TEST(Episode, AFolderThatIsNoEpisodeIsNamed) {
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

TEST(Episode, NumbersThatAreNoneInADescriptionAreDamage) {
  TempDir folder;
  const fs::path file = SampleEpisode().Write(folder.path(), "a") / "episode.json";
  const auto good = nlohmann::ordered_json::parse(ReadFile(file));
  for (const char* at : {"/files/steps.h5/bytes", "/cameras/wrist/width", "/cameras/wrist/fps/0"}) {
    auto bad = good;
    bad[nlohmann::json::json_pointer(at)] = 5.3e81;
    bad["run"][kJsonHash] = kUnsigned;
    AtomicWrite(file, SignJson(bad.dump(2)));
    ExpectThrow<IoError>([&] { Episode episode(folder / "a"); },
                         "episode.json is damaged: it is signed, and yet no description");
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
  const std::string text =
      ExpectThrow<IoError>([&] { episode.Read<double>("time"); },
                           "'steps.h5' is not what was written: the hash does not fit");
  EXPECT_THAT(text, HasSubstr("`robocell verify --repair "));
  const size_t digit = ReadFile(folder / "a" / "episode.json").find("\"rows\": 3") + 8;
  flip("episode.json", digit);  // another number of rows, and still JSON
  ExpectThrow<IoError>([&] { Episode(folder / "a"); },
                       "episode.json is damaged: its text is not what was written");
}

TEST(Episode, AFileThatIsMissingOrShortIsNamedWhenItIsOpened) {
  TempDir folder;
  const fs::path path = SampleEpisode().Write(folder.path(), "a");
  fs::resize_file(path / "wrist.mp4", 100);
  ExpectThrow<IoError>([&] { Episode episode(path); }, "'wrist.mp4' has 100 bytes");
  fs::remove(path / "wrist.mp4");
  ExpectThrow<IoError>([&] { Episode episode(path); }, "'wrist.mp4': No such file or directory");
}

}  // namespace
}  // namespace robocell
