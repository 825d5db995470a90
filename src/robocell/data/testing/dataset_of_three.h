// For tests only: a dataset of three episodes on the disk, for tests that damage it.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "robocell/data/dataset.h"
#include "robocell/data/testing/sample_episode.h"
#include "robocell/data/verify.h"
#include "robocell/media/testing/videos.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {

// A dataset of three episodes; `b` is the one that gets damaged.
class DatasetOfThree : public ::testing::Test {
 protected:
  DatasetOfThree() {
    std::filesystem::copy(Original().path(), folder_.path(),
                          std::filesystem::copy_options::recursive);
  }

  // Written once: encoders take time to start.
  static const TempDir& Original() {
    static const TempDir folder;
    static const bool written = [] {
      for (const char* id : {"a", "b", "c"})
        SampleEpisode(id[0], true, true).Write(folder.path(), id, 10);
      return true;
    }();
    (void)written;
    return folder;
  }

  std::filesystem::path B(const std::string& file) const { return folder_ / "b" / file; }

  // Returns the only problem as text, after checking that the other episodes are still good and
  // readable.
  std::string OnlyProblem() {
    const VerifyResult result = Verify(folder_.path());
    EXPECT_THAT(result.good, ::testing::ElementsAre("a", "c"));
    EXPECT_THAT(result.bad, ::testing::ElementsAre("b"));
    EXPECT_EQ(result.problems.size(), 1u) << result.Text();
    EXPECT_EQ(Dataset(folder_.path()).Open("c").Read<double>("time").size(), 10u);
    return result.problems.empty() ? "" : result.problems[0].Text();
  }

  TempDir folder_;
};

}  // namespace robocell
