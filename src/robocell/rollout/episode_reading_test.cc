#include "robocell/rollout/episode_reading.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "robocell/data/testing/sample_episode.h"
#include "robocell/spec/run_config.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

class EpisodeReading : public ::testing::Test {
 protected:
  TempDir folder_;
  const Episode episode_{SampleEpisode(7, false).Write(folder_.path(), "e0")};
  const EpisodeJson metadata_ = EpisodeJson::Metadata(episode_);
};

TEST_F(EpisodeReading, GivesTheValuesOfTheFields) {
  EXPECT_EQ(metadata_.At("spec").AsText(), "name: pick");
  EXPECT_EQ(metadata_.At("seed").value(), 7);
  EXPECT_FALSE(metadata_.Find("sed"));
  EXPECT_FALSE(metadata_.At("spec").Find("name")) << "a text has no fields";
  EXPECT_EQ(EpisodeJson::Versions(episode_).At("mujoco").AsText(), "4.0.0");
}

TEST_F(EpisodeReading, NamesFileAndFieldOfMissingValues) {
  ExpectThrow<IoError>([&] { metadata_.At("identity"); },
                       "e0/episode.json': 'metadata' has no field 'identity'; the episode was "
                       "edited or comes from another program");
  ExpectThrow<IoError>([&] { metadata_.At("seed").AsText(); }, "'metadata.seed' is 7, not a text");
  ExpectThrow<IoError>([&] { metadata_.At("seed").At("of"); },
                       "'metadata.seed' is 7, not an object");
  ExpectThrow<IoError>([&] { metadata_.At("seed").Items(); }, "is 7, not a list");
  ExpectThrow<IoError>([&] { metadata_.At("seed").AsNumbers(); }, "is 7, not a list of numbers");
  ExpectThrow<IoError>([&] { metadata_.At("seed").AsBool(); }, "is 7, not true or false");
  ExpectThrow<IoError>([&] { metadata_.At("spec").AsSpec<RunConfig>(); },
                       "'metadata.spec' is \"name: pick\", not what robocell writes there");
}

TEST_F(EpisodeReading, StepsHaveARowForEachStep) {
  EXPECT_EQ(ReadSteps<double>(episode_, "reward").size(), static_cast<size_t>(episode_.rows()));
  ExpectThrow<IoError>([&] { ReadSteps<double>(episode_, "control/ctrl"); }, "has ");
}

}  // namespace
}  // namespace robocell::internal
