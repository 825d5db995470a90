#include "robocell/spec/field_places.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/spec/env_config.h"
#include "robocell/spec/run_config.h"
#include "robocell/spec/testing/messages.h"

namespace robocell {
namespace {

using ::testing::HasSubstr;
using testing::ParseError;

TEST(FieldPlaces, PartsOfARunOrAnEnvironmentAreNamed) {
  EXPECT_EQ(PlaceHint("RunConfig", "renderer"), " It is a field of `cameras`: cameras.renderer");
  EXPECT_EQ(PlaceHint("RunConfig", "policy_hz"), " It is a field of `rates`: rates.policy_hz");
  EXPECT_EQ(PlaceHint("EnvConfig", "frequency"), " It is a field of `sim`: sim.frequency");
  EXPECT_EQ(PlaceHint("RendererConfig", "shadows"),
            " It is a field of `cameras.renderer.quality`: cameras.renderer.quality.shadows");
  EXPECT_EQ(PlaceHint("RunConfig", "of_nobody"), "");
  EXPECT_EQ(PlaceHint("RobotConfig", "renderer"), "");
}

TEST(FieldPlaces, AppearInErrorsOfFiles) {
  const std::string begin = "run: a\nrobot: {name: b, model: c}\noutput: d\n";
  EXPECT_THAT(ParseError<RunConfig>(begin + "cameras: {backend: soft}\n"),
              HasSubstr("It is a field of `cameras.renderer`: cameras.renderer.backend"));
  EXPECT_THAT(ParseError<RunConfig>(begin + "cameras: {quality: high}\n"),
              HasSubstr("It is a field of `cameras.renderer`: cameras.renderer.quality"));
  EXPECT_THAT(ParseError<RunConfig>(begin + "renderer: soft\n"),
              HasSubstr("It is a field of `cameras`: cameras.renderer"));
  EXPECT_THAT(ParseError<RunConfig>(begin + "scenes: {kind: tabletop}\n"),
              HasSubstr("The kind is named by `source`"));
  EXPECT_THAT(ParseError<RunConfig>(begin + "task: {source: pick}\n"),
              HasSubstr("The kind is named by `kind`"));
  EXPECT_THAT(ParseError<EnvConfig>("renderer: soft\n"),
              HasSubstr("It is a field of `cameras`: cameras.renderer"));
}

// The parser gives a missing value the place of what comes after it.
TEST(FieldPlaces, AMissingValueIsReportedAtItsKey) {
  const std::string begin = "run: a\nrobot: {name: b, model: c}\n";
  EXPECT_THAT(ParseError<RunConfig>(begin + "task:\noutput: d\n"), HasSubstr(":3:1: task: "));
  EXPECT_THAT(ParseError<RunConfig>(begin + "output: d\ntask:\n"), HasSubstr(":4:1: task: "));
  EXPECT_THAT(ParseError<RunConfig>(begin + "cameras:\n  resolution:\n  streams: []\noutput: d\n"),
              HasSubstr(":4:3: cameras.resolution: "));
  EXPECT_THAT(ParseError<RunConfig>(begin + "seed:\n\n\noutput: d\n"), HasSubstr(":3:1: seed: "));
}

}  // namespace
}  // namespace robocell
