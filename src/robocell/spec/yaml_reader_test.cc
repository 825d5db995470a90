// Tests the reader of single values; messages about whole files are tested in yaml_test.cc.
#include "robocell/spec/yaml_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "robocell/testing/expect_throw.h"

namespace robocell::internal::yaml {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// Reads a text as a value of T. `problems`: the problems, if any are expected.
template <class T>
T ReadAs(const std::string& text, std::vector<std::string>* problems = nullptr) {
  Reader reader("f.yaml", "");
  T value{};
  reader.Read(ParseText(text, "f.yaml"), value);
  std::vector<std::string> messages;
  for (const Problem& problem : reader.problems().list())
    messages.push_back(problem.source + ": " + problem.message);
  if (problems)
    *problems = messages;
  else
    EXPECT_THAT(messages, IsEmpty()) << text;
  return value;
}

template <class T>
std::string ProblemOf(const std::string& text) {
  std::vector<std::string> problems;
  ReadAs<T>(text, &problems);
  return problems.size() == 1 ? problems[0] : std::to_string(problems.size()) + " problems";
}

TEST(YamlReader, NumbersAreReadToTheBit) {
  for (const double number : {0.1, -2.5e-300, 1.0 / 3, 123456789.125, -0.0}) {
    char text[40];
    snprintf(text, sizeof text, "%.17g", number);
    EXPECT_EQ(ReadAs<double>(text), number);
    EXPECT_EQ(std::signbit(ReadAs<double>(text)), std::signbit(number));
  }
  EXPECT_EQ(ReadAs<double>("+1.5"), 1.5);
  EXPECT_EQ(ReadAs<double>("1/3"), 1.0 / 3);
  EXPECT_EQ(ReadAs<double>("-.inf"), -INFINITY);
  EXPECT_TRUE(std::isnan(ReadAs<double>(".nan")));
}

TEST(YamlReader, RejectsTextsThatAreNoNumbers) {
  for (const char* text : {"1.5m", "1,5", "one", "1/0", "+-1", "0x10", "[1]", "{a: 1}", ""})
    EXPECT_THAT(ProblemOf<double>(text), HasSubstr("expected a number")) << text;
}

TEST(YamlReader, WholeNumbersHaveLimits) {
  EXPECT_EQ(ReadAs<int>("-2147483648"), std::numeric_limits<int>::min());
  EXPECT_EQ(ReadAs<int64_t>("9223372036854775807"), std::numeric_limits<int64_t>::max());
  EXPECT_EQ(ProblemOf<int>("2147483648"),
            "f.yaml:1:1: expected a whole number of at most 2147483647, found '2147483648'");
  EXPECT_EQ(ProblemOf<int>("-2147483649"),
            "f.yaml:1:1: expected a whole number not below -2147483648, found '-2147483649'");
  EXPECT_EQ(ProblemOf<int>("1e3"), "f.yaml:1:1: expected a whole number, found '1e3'; write 1000");
  EXPECT_EQ(ProblemOf<int>("1.5"), "f.yaml:1:1: expected a whole number, found '1.5'");
}

// Other words of YAML 1.1, such as `no` for Norway, are texts.
TEST(YamlReader, OnlyTrueAndFalseAreTruthValues) {
  EXPECT_TRUE(ReadAs<bool>("true"));
  EXPECT_FALSE(ReadAs<bool>("False"));
  for (const char* text : {"yes", "no", "on", "1", "TRUE", ""})
    EXPECT_THAT(ProblemOf<bool>(text), HasSubstr("expected true or false")) << text;
}

TEST(YamlReader, NamesExpandRangesUnlessTheyAreQuoted) {
  EXPECT_THAT(ReadAs<NameList>("joint1..joint3").names, ElementsAre("joint1", "joint2", "joint3"));
  EXPECT_THAT(ReadAs<NameList>("[base, j1..j2]").names, ElementsAre("base", "j1", "j2"));
  EXPECT_THAT(ReadAs<NameList>("'joint1..joint3'").names, ElementsAre("joint1..joint3"));
  std::vector<std::string> problems;
  EXPECT_THAT(ReadAs<NameList>("[a, joint7..joint1]", &problems).names, IsEmpty())
      << "an incomplete list is not compared with others";
  EXPECT_EQ(problems.size(), 1);
}

TEST(YamlReader, IndicesExpandRisingRanges) {
  EXPECT_THAT(ReadAs<IndexList>("2..5").values, ElementsAre(2, 3, 4, 5));
  EXPECT_THAT(ReadAs<IndexList>("[7, 0..1]").values, ElementsAre(7, 0, 1));
  EXPECT_THAT(ProblemOf<IndexList>("5..2"), HasSubstr("a rising range like 0..3"));
  EXPECT_THAT(ProblemOf<IndexList>("0..9999999"), HasSubstr("more than 2000000 numbers"));
}

TEST(YamlReader, APoseHasOneRotation) {
  const Pose turned = ReadAs<Pose>("{pos: [1, 2, 3], quat_wxyz: [0.7071, 0, 0, 0.7071]}");
  EXPECT_EQ(turned.translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_NEAR((turned.rotation() * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(), 0,
              1e-12)
      << "a quaternion of few digits is normalised";
  EXPECT_THAT(ProblemOf<Pose>("{quat: [0, 0, 0, 1], quat_wxyz: [1, 0, 0, 0]}"),
              HasSubstr("both quat and quat_wxyz are given"));
  EXPECT_THAT(ProblemOf<Pose>("{pso: [0, 0, 0]}"), HasSubstr("Did you mean 'pos'?"));
}

TEST(YamlReader, ATextIsOneDocumentOfYaml) {
  ExpectThrow<SpecError>([] { ParseText("a: [1, 2", "f.yaml"); }, "f.yaml:1:");
  ExpectThrow<SpecError>([] { ParseText("a: 1\n---\nb: 2\n", "f.yaml"); }, "document");
  const std::string deep(10'000, '[');
  ExpectThrow<SpecError>([&] { ParseText(deep, "f.yaml"); }, "f.yaml");
}

// Each level of aliases multiplies the number of values.
TEST(YamlReader, AliasesCannotExplode) {
  std::string text = "a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n";
  for (int i = 1; i < 7; ++i) {
    const std::string before = "*a" + std::to_string(i - 1);
    text += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + before;
    for (int k = 1; k < 10; ++k) text += ", " + before;
    text += "]\n";
  }
  const YAML::Node root = ParseText(text, "f.yaml");
  Reader reader("f.yaml", "");
  std::vector<std::vector<std::vector<std::vector<std::vector<std::vector<std::vector<int>>>>>>>
      out;
  ExpectThrow<SpecError>([&] { reader.Read(root["a6"], out); }, "more than 200000 values");
}

TEST(YamlReader, AnOverrideIsAPathAndAValue) {
  const Override override = ParseOverride("task.lift_height=0.05");
  EXPECT_EQ(override.path, "task.lift_height");
  EXPECT_EQ(override.value.as<double>(), 0.05);
  EXPECT_EQ(ParseOverride("a.b=x=y").value.Scalar(), "x=y") << "the first = divides";
  for (const char* text : {"task", "", "=1"})
    ExpectThrow<ArgumentError>([&] { ParseOverride(text); }, "path");
}

}  // namespace
}  // namespace robocell::internal::yaml
