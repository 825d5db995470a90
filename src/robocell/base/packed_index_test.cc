#include "robocell/base/packed_index.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/sample_pack.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

using ::testing::ElementsAre;

class PackedIndexTest : public ::testing::Test {
 protected:
  void ExpectError(const std::string& told) const {
    ExpectThrow<IoError>([&] { PackedIndexOf(folder_.path()); }, told);
  }

  TempDir folder_;
  SamplePack pack_{folder_.path()};
};

TEST_F(PackedIndexTest, ListsTheFilesOfEpisodes) {
  const auto index = PackedIndexOf(folder_.path());
  ASSERT_TRUE(index);
  EXPECT_TRUE(index->Contains("e"));
  EXPECT_FALSE(index->Contains("f"));
  EXPECT_THAT(index->FilesOf("e"), ElementsAre("episode.json", "steps.h5"));
  EXPECT_EQ(IndexAround(folder_ / "e/anything"), index) << "read once";
}

TEST_F(PackedIndexTest, AWrittenIndexIsReadAnew) {
  const auto index = PackedIndexOf(folder_.path());
  pack_.Write(SamplePack::Shards());
  EXPECT_NE(PackedIndexOf(folder_.path()), index);
  std::filesystem::remove(folder_ / "packed.json");
  EXPECT_FALSE(PackedIndexOf(folder_.path()));
}

TEST_F(PackedIndexTest, ThreadsShareAnIndex) {
  const auto index = PackedIndexOf(folder_.path());
  std::atomic<int> others = 0;
  std::vector<std::jthread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&] {
      for (int j = 0; j < 500; ++j) others += PackedIndexOf(folder_.path()) != index;
    });
  }
  threads.clear();
  EXPECT_EQ(others, 0);
}

TEST_F(PackedIndexTest, FilesAreListedInAnyOrder) {
  pack_.Write(R"([{"file": "s.zip", "bytes": 9, "rest_sha256": "", "files": {)"
              R"("e/z": {"offset": 2, "bytes": 2, "sha256": ""}, )"
              R"("e/episode.json": {"offset": 6, "bytes": 3, "sha256": ""}}}])");
  EXPECT_THAT(PackedIndexOf(folder_.path())->shards.at(0).parts,
              ElementsAre("e/z", "e/episode.json"));
}

TEST_F(PackedIndexTest, DamageNamesTheIndex) {
  const std::string shards = SamplePack::Shards();
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string changed = shards;
    return changed.replace(changed.find(from), from.size(), to);
  };
  pack_.Write(SamplePack::Shards(), R"(["e", "f"])");
  ExpectError("it lists no episode.json of episode 'f'");
  pack_.Write(SamplePack::Shards(), R"(["e"])", 1);
  ExpectError("is not of format version 2");
  pack_.Write(with("\"bytes\": 3", "\"bytes\": 4"));
  ExpectError("the bytes of 'e/steps.h5' are not in 's.zip'");
  pack_.Write(with("\"offset\": 6", "\"offset\": 3"));
  ExpectError("the bytes of 'e/steps.h5' are not in 's.zip'");
  pack_.Write(with("\"bytes\": 3", "\"bytes\": 18446744073709551615"));
  ExpectError("the bytes of 'e/steps.h5' are not in 's.zip'");
  pack_.Write(with("\"bytes\": 3", "\"bytes\": -3"));
  ExpectError("it does not describe a packed dataset");
  for (const char* outside : {"../e", "/e", "a/../../e", ".state/e", "a//b"}) {
    pack_.Write(with("e/steps.h5", outside));
    ExpectError("which is not inside a dataset");
  }
  pack_.Write(with("\"s.zip\"", "\"../s.zip\""));
  ExpectError("which is not inside a dataset");
  AtomicWrite(folder_ / "packed.json", "{");
  ExpectError("packed.json' is damaged");
}

TEST_F(PackedIndexTest, NothingIsWrittenIntoIt) {
  EXPECT_NO_THROW(RequireNotPacked(folder_ / "e", "write"));
  ExpectThrow<ArgumentError>([&] { RequireNotPacked(folder_.path(), "write"); },
                             "it is a packed dataset, which is only read. `robocell unpack");
}

}  // namespace
}  // namespace robocell::internal
