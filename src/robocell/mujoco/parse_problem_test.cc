// Tests the messages of the engine's own reader, in their present form.
#include "robocell/mujoco/parse_problem.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <filesystem>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/mujoco/compile.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;

// Returns the message of ParseXmlFile for a model in which the third line is `line`, without the
// folder.
std::string ProblemOf(const std::string& line) {
  const TempDir folder;
  AtomicWrite(folder.path() / "arm.xml",
              "<mujoco>\n<worldbody>\n" + line + "\n</worldbody></mujoco>");
  std::string message =
      ExpectThrow<SpecError>([&] { ParseXmlFile(folder.path() / "arm.xml"); }, "");
  const std::string in = folder.path().string() + "/";
  for (size_t at = message.find(in); at != std::string::npos; at = message.find(in))
    message.erase(at, in.size());
  return message;
}

TEST(ParseProblem, SuggestsTheNearestAttributeOrElement) {
  EXPECT_EQ(ProblemOf("<geom tpye='box'/>"),
            "arm.xml:3: <geom>: unrecognized attribute: 'tpye'. Did you mean 'type'? Correct it "
            "there; MJCF's elements and attributes: "
            "https://mujoco.readthedocs.io/en/stable/XMLreference.html");
  EXPECT_THAT(ProblemOf("<gemo/>"),
              HasSubstr("arm.xml:3: <gemo>: unrecognized element. Did you mean "
                        "'geom'? Correct it there"));
  EXPECT_THAT(ProblemOf("<geom qqqqqqqqqqqq='1'/>"),
              AllOf(HasSubstr("'qqqqqqqqqqqq'. Correct it"), Not(HasSubstr("Did you mean"))));
}

TEST(ParseProblem, ReportsTheLineOfAWrongValue) {
  EXPECT_THAT(ProblemOf("<geom type='bx'/>"),
              HasSubstr("arm.xml:3: <geom>: invalid keyword: 'bx'. "));
  EXPECT_THAT(ProblemOf("<geom pos='1 2 x'/>"),
              HasSubstr("arm.xml:3: <geom>: bad format in attribute 'pos'. "));
}

TEST(ParseProblem, ReportsMalformedXml) {
  EXPECT_EQ(ProblemOf("<body>"),
            "arm.xml:3: <body>: not well-formed XML: mismatched element. Each element that is "
            "opened is closed, inside of the one around it, and each attribute is written "
            "name=\"value\"");
  EXPECT_THAT(ProblemOf("<geom size=1/>"),
              HasSubstr("arm.xml:3: <geom>: not well-formed XML: parsing "
                        "attribute. "));
}

TEST(ParseProblem, ReportsAGitLfsPointer) {
  const TempDir folder;
  AtomicWrite(folder.path() / "arm.xml",
              "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n");
  ExpectThrow<SpecError>([&] { ParseXmlFile(folder.path() / "arm.xml"); },
                         "arm.xml: a pointer of Git LFS, not the file itself: run `git lfs pull`");
}

TEST(ParseProblem, SuggestsTheNearestIncludedFile) {
  const auto message = [](const std::string& include, const std::string& there) {
    const TempDir folder;
    std::filesystem::create_directory(folder.path() / "parts");
    AtomicWrite(folder.path() / there, "<mujoco/>");
    const std::string file = (folder.path() / "arm.xml").string();
    AtomicWrite(file, "<mujoco>\n<include file='" + include + "'/>\n</mujoco>");
    return ExpectThrow<SpecError>([&] { ParseXmlFile(file); }, file + ":2: <include>: ");
  };
  EXPECT_THAT(message("asets.xml", "assets.xml"),
              HasSubstr("Error opening file 'asets.xml'. Did you mean 'assets.xml'? Correct it"));
  EXPECT_THAT(message("parts/lnk.xml", "parts/link.xml"),
              HasSubstr("Did you mean 'parts/link.xml'?"));
  EXPECT_THAT(message("hand.xml", "gripper.xml"),
              HasSubstr("'hand.xml'. There: gripper.xml. Correct"));
}

TEST(ParseProblem, ReportsTheLineOfMalformedXmlInAnIncludedFile) {
  const TempDir folder;
  const std::string part = (folder.path() / "part.xml").string();
  AtomicWrite(part, "<mujoco>\n<asset>\n</mujoco>");
  AtomicWrite(folder.path() / "arm.xml", "<mujoco>\n<include file='part.xml'/>\n</mujoco>");
  ExpectThrow<SpecError>([&] { ParseXmlFile(folder.path() / "arm.xml"); },
                         part + ":2: <asset>: not well-formed XML: mismatched element. Each");
}

TEST(ParseProblem, ReportsFilesThatAreNotModels) {
  const TempDir folder;
  const std::string file = (folder.path() / "x.xml").string();
  const auto message = [&](const std::string& text) {
    AtomicWrite(file, text);
    return ExpectThrow<SpecError>([&] { ParseXmlFile(file, "robot 'a'"); }, "robot 'a': " + file);
  };
  EXPECT_THAT(message("<html/>"),
              HasSubstr("x.xml: Unrecognized XML model type: 'html'. Correct it"));
  EXPECT_THAT(message(""), HasSubstr("x.xml: empty file"));
  EXPECT_THAT(message("hello"), HasSubstr("x.xml:1: not well-formed XML: parsing text"));
}

TEST(ParseProblem, OfATextHasTheLineAlone) {
  EXPECT_THAT(ExpectThrow<SpecError>([] { ParseXmlString("<mujoco>\n<wrldbody/></mujoco>"); }, ""),
              HasSubstr("line 2: <wrldbody>: unrecognized element. Did you mean 'worldbody'?"));
}

TEST(ParseProblem, LinesOfIncludedFilesAreUnknown) {
  EXPECT_EQ(ParseProblem("XML Error: Schema violation: unrecognized attribute: 'nam'\nElement "
                         "'mesh', line 0\n",
                         "arm.xml")
                .substr(0, 46),
            "arm.xml: <mesh>: unrecognized attribute: 'nam'");
}

}  // namespace
}  // namespace robocell::internal
