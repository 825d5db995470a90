// Tests malicious files: nesting, aliases, sizes, noise. They quickly end in a SpecError.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robocell/base/rng.h"
#include "robocell/spec/robot_config.h"
#include "robocell/spec/run_config.h"
#include "robocell/spec/testing/messages.h"
#include "robocell/spec/testing/random_spec.h"

namespace robocell {
namespace {

using ::testing::HasSubstr;
using testing::ParseError;

std::string Repeat(const std::string& text, int n) {
  std::string out;
  for (int i = 0; i < n; ++i) out += text;
  return out;
}

TEST(HostileYaml, RejectsDeepNestingBeforeParsing) {
  for (const std::string piece : {"[", "{", "{a: ", "- ", "? ", "[{a: ", ": "}) {
    EXPECT_THAT(
        ParseError<RobotConfig>(Repeat(piece, 100'000)),
        ::testing::AnyOf(HasSubstr("nested more than 64 levels deep"), HasSubstr("not valid YAML")))
        << piece;
  }
  std::string steps;
  for (int i = 0; i < 1000; ++i) steps += std::string(i, ' ') + "a:\n";
  EXPECT_THAT(ParseError<RobotConfig>(steps), HasSubstr("nested more than 64 levels deep"));
}

TEST(HostileYaml, AliasesWork) {
  const auto robot = ParseYaml<RobotConfig>(
      "name: a\nmodel: b\nmove_groups:\n  left: &g {joints: [x]}\n  right: *g\n");
  EXPECT_EQ(robot.move_groups.at("right").joints, NameList{"x"});
}

TEST(HostileYaml, AliasesDoNotExplode) {
  // Ten thousand lists of ten thousand names would be a hundred million.
  std::string text = "name: a\nmodel: b\nmove_groups:\n  g: {joints: &l [n0";
  for (int i = 1; i < 10'000; ++i) text += ", n" + std::to_string(i);
  text += "]}\n";
  for (int i = 0; i < 10'000; ++i) text += "  g" + std::to_string(i) + ": {joints: *l}\n";
  EXPECT_THAT(ParseError<RobotConfig>(text), HasSubstr("more than 200000 values"));
}

TEST(HostileYaml, RejectsABillionLaughs) {
  std::string text = "name: &l0 [lol, lol]\nmodel: b\n";
  for (int i = 1; i < 60; ++i) {
    text += "x" + std::to_string(i) + ": &l" + std::to_string(i) + " " + "[" +
            Repeat("*l" + std::to_string(i - 1) + ", ", 9) + "]\n";
  }
  EXPECT_THAT(ParseError<RobotConfig>(text), HasSubstr("60 problems:"));
}

TEST(HostileYaml, RejectsASelfReferencingAlias) {
  EXPECT_NE(ParseError<RobotConfig>("name: a\nmodel: b\nbase: &b {kind: mocap, size: *b}\n"), "");
  EXPECT_NE(ParseError<RobotConfig>("name: a\nmodel: b\nedits: &e [*e]\n"), "");
  EXPECT_NE(ParseError<RobotConfig>("&a {name: a, model: b, base: *a}\n"), "");
  EXPECT_NE(ParseError<RobotConfig>("name: *nowhere\n"), "");
}

TEST(HostileYaml, RejectsHugeRanges) {
  const std::string start = "run: r\nrobot: {name: a, model: b}\noutput: o\n";
  EXPECT_THAT(ParseError<RunConfig>(start + "scenes: {houses: 0..999999999}\n"),
              HasSubstr("f.yaml:4:18: scenes.houses: more than 2000000 numbers"));
  EXPECT_THAT(ParseError<RunConfig>(start + "scenes: {houses: 0..99999999999}\n"),
              HasSubstr("expected whole numbers: a list, or a rising range like 0..3"));
}

TEST(HostileYaml, RejectsALargeFile) {
  EXPECT_THAT(ParseError<RobotConfig>("#" + std::string(17 << 20, 'x')),
              HasSubstr("is larger than 16 MB"));
}

TEST(HostileYaml, RejectsEndlessDocuments) {
  EXPECT_THAT(ParseError<RobotConfig>(", 0.03], name: a\nmodel: b\n"),
              HasSubstr("this does not belong to what stands above"));
}

TEST(HostileYaml, ShortensThousandsOfProblems) {
  std::string text = "name: a\nmodel: b\n";
  for (int i = 0; i < 5000; ++i) text += "zz" + std::to_string(i) + ": 1\n";
  const std::string error = ParseError<RobotConfig>(text);
  EXPECT_THAT(error, HasSubstr("5000 problems:"));
  EXPECT_THAT(error, HasSubstr("and 4950 more"));
}

TEST(HostileYaml, DamagedTextGivesOnlySpecErrors) {
  for (uint64_t seed = 0; seed < 300; ++seed) {
    Rng rng = Rng::Stream(seed, "damage");
    std::string text = ToYaml(testing::RandomSpec(seed).Make<RobotConfig>());
    for (int i = 0; i < 3; ++i) {
      const size_t at = rng.UniformInt(text.size());
      if (rng.UniformInt(2)) text.erase(at, rng.UniformInt(20));
      text.insert(at < text.size() ? at : 0, 1, static_cast<char>(rng.UniformInt(256)));
    }
    try {
      ParseYaml<RobotConfig>(text);
    } catch (const SpecError&) {
    }
  }
}

}  // namespace
}  // namespace robocell
