#include "robocell/base/stored_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/hash.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/sample_pack.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

using ::testing::ElementsAre;

TEST(StoredFile, AFileOfAPackedEpisodeIsBytesOfItsShard) {
  const TempDir folder;
  const SamplePack pack(folder.path());
  const std::filesystem::path steps = folder / "e/steps.h5", shard = folder / "s.zip";
  EXPECT_EQ(ReadStoredFile(steps), "abc");
  EXPECT_EQ(Sha256StoredFile(steps), Sha256("abc"));
  EXPECT_EQ(StoredFileBytes(steps), 3u);
  EXPECT_EQ(WhatIsStoredAt(steps), "a file");
  EXPECT_TRUE(CanReadStoredFile(steps));
  EXPECT_EQ(WhatIsStoredAt(folder / "e/other"), "nothing");
  EXPECT_FALSE(CanReadStoredFile(folder / "e/other"));
  EXPECT_THAT(StoredNames(folder / "e"), ElementsAre("episode.json", "steps.h5"));
  EXPECT_EQ(FfmpegInput(steps), "subfile,,start,6,end,9,,:file:" + shard.string());
  ExpectThrow<IoError>([&] { ReadStoredFile(steps, 2); }, "it has 3 bytes, 2 are the most");

  const std::string identity = StoredFileIdentity(steps);
  EXPECT_NE(identity, StoredFileIdentity(folder / "e/episode.json"));
  AtomicWrite(shard, "--{}..a");
  EXPECT_NE(StoredFileIdentity(steps), identity);
  EXPECT_EQ(StoredFileBytes(steps), 1u);
  ExpectThrow<IoError>([&] { ReadStoredFile(steps); }, "is cut short: it ends at byte 7");
  std::filesystem::remove(shard);
  EXPECT_EQ(WhatIsStoredAt(steps), "nothing");
  ExpectThrow<IoError>([&] { RequireStoredFile(steps); }, shard.string());
}

TEST(StoredFile, AFileOfItsOwnIsThatFile) {
  const TempDir folder;
  std::filesystem::create_directory(folder / "e");
  const std::filesystem::path file = folder / "e/steps.h5";
  AtomicWrite(file, "abc");
  EXPECT_FALSE(PartAt(file));
  EXPECT_EQ(ReadStoredFile(file), "abc");
  EXPECT_EQ(StoredFileBytes(file), 3u);
  EXPECT_EQ(StoredFileIdentity(file), FileIdentity(file));
  EXPECT_THAT(StoredNames(folder / "e"), ElementsAre("steps.h5"));
  EXPECT_EQ(FfmpegInput(file), "file:" + file.string());
}

}  // namespace
}  // namespace robocell::internal
