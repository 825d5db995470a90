#include "robocell/scene/inspection/findings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace robocell::internal {
namespace {

using ::testing::ElementsAre;

TEST(Findings, KnowWhereFieldsStand) {
  Findings findings("robot 'r'", [](const std::string& subject, std::string_view field) {
    return subject + " at " + std::string(field);
  });
  findings.Warn("home", "text", "{}");
  findings.WarnOf("camera", "pos", "text");
  findings.WarnAbout("base", "text");
  findings.WarnAbout("base", "r.yaml:7:73: a text with a place");
  findings.WarnAt("arm.xml:3", "text");
  findings.Note("good to know");
  std::vector<std::string> lines;
  for (const Finding& finding : findings.list()) lines.push_back(Line(finding));
  EXPECT_THAT(lines,
              ElementsAre("robot 'r' at home: robot 'r': text", "camera at pos: camera: text",
                          "robot 'r' at base: robot 'r': base: text",
                          "r.yaml:7:73: robot 'r': a text with a place",
                          "arm.xml:3: robot 'r': text", "robot 'r': good to know"));
  EXPECT_EQ(findings.list()[0].edit, "{}");
  EXPECT_EQ(findings.list().back().severity, Severity::kNote);
}

}  // namespace
}  // namespace robocell::internal
