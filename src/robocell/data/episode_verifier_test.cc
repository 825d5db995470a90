#include "robocell/data/episode_verifier.h"

#include <sys/stat.h>
#include <unistd.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/files.h"
#include "robocell/data/testing/dataset_of_three.h"
#include "robocell/data/verify.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

class EpisodeVerifierTest : public DatasetOfThree {};

TEST_F(EpisodeVerifierTest, AFlippedBitIsFoundAnywhereInEveryFile) {
  for (const std::string file : {"steps.h5", "wrist.mp4", "episode.json", "scene.mjb"}) {
    const std::string whole = ReadFile(B(file));
    for (int part = 0; part < 25; ++part) {
      std::string flipped = whole;
      const size_t at = whole.size() * part / 25;
      flipped[at] ^= static_cast<char>(1 << part % 8);
      Store(B(file), flipped);
      const std::vector<VerifyProblem> problems = EpisodeVerifier(false).Verify(folder_ / "b");
      ASSERT_EQ(problems.size(), 1u) << file << " byte " << at;
      EXPECT_EQ(problems[0].file, file);
      EXPECT_THAT(problems[0].reason, HasSubstr("hash does not match"));
    }
    Store(B(file), whole);
  }
  EXPECT_TRUE(Verify(folder_.path()).ok());
}

TEST_F(EpisodeVerifierTest, ATruncatedFileIsFoundAtEveryLength) {
  for (const std::string file : {"steps.h5", "wrist.mp4", "episode.json", "scene.mjb"}) {
    const std::string whole = ReadFile(B(file));
    for (int part = 0; part < 20; ++part) {
      Store(B(file), whole.substr(0, whole.size() * part / 20));
      const std::vector<VerifyProblem> problems = EpisodeVerifier(false).Verify(folder_ / "b");
      ASSERT_EQ(problems.size(), 1u) << file << " part " << part;
      EXPECT_EQ(problems[0].file, file);
    }
    Store(B(file), whole);
  }
  fs::resize_file(B("steps.h5"), 4096);
  EXPECT_THAT(OnlyProblem(), HasSubstr("b/steps.h5: it is cut short: 4096 of "));
}

TEST_F(EpisodeVerifierTest, AMissingFileIsNamed) {
  fs::remove(B("wrist.mp4"));
  EXPECT_EQ(OnlyProblem(), "b/wrist.mp4: it is missing");
}

// The layout of a download cache: all files are links to blobs beside the dataset.
TEST_F(EpisodeVerifierTest, AcceptsLinksToFiles) {
  TempDir blobs;
  for (const char* file : {"episode.json", "steps.h5", "scene.mjb"}) {
    fs::copy(B(file), blobs / file);
    fs::remove(B(file));
    fs::create_symlink(blobs / file, B(file));
  }
  const VerifyResult result = Verify(folder_.path());
  EXPECT_TRUE(result.problems.empty()) << result.Text();
  EXPECT_GT(Episode(folder_ / "b").rows(), 0);
  std::string bytes = ReadFile(blobs / "scene.mjb");
  bytes[10] ^= 1;
  Store(blobs / "scene.mjb", bytes);
  EXPECT_THAT(OnlyProblem(), HasSubstr("b/scene.mjb: its hash does not match its bytes"));
  fs::remove(blobs / "scene.mjb");
  EXPECT_EQ(OnlyProblem(), fmt::format("b/scene.mjb: it is a link to '{}', where there is nothing, "
                                       "not a file",
                                       (blobs / "scene.mjb").string()));
  EXPECT_THAT(Repair(folder_.path()).moved, ElementsAre("b"));
  EXPECT_TRUE(fs::exists(blobs / "steps.h5")) << "the links were moved, not what they lead to";
}

TEST_F(EpisodeVerifierTest, NamesDamagedDepthAndAcceptsIntactDepth) {
  EXPECT_TRUE(Verify(folder_.path(), {.decode_videos = true}).ok());
  std::string bytes = ReadFile(B("wrist.depth.mov"));
  bytes[bytes.size() / 2] ^= 1;
  Store(B("wrist.depth.mov"), bytes);
  EXPECT_THAT(OnlyProblem(), HasSubstr("b/wrist.depth.mov: its hash does not match its bytes"));
}

TEST_F(EpisodeVerifierTest, SwappedVideosOfTwoEpisodesAreFound) {
  fs::rename(B("wrist.mp4"), folder_ / "x");
  fs::rename(folder_ / "a" / "wrist.mp4", B("wrist.mp4"));
  fs::rename(folder_ / "x", folder_ / "a" / "wrist.mp4");
  EXPECT_THAT(Verify(folder_.path()).bad, ElementsAre("a", "b"));
}

}  // namespace
}  // namespace robocell::internal
