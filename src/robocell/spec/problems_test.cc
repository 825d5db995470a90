#include "robocell/spec/problems.h"

#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/testing/expect_throw.h"

namespace robocell {
namespace {

TEST(Problems, OneProblemFitsOnALine) {
  Problems problems;
  problems.AddAt("pos", "is wrong");
  EXPECT_EQ(problems.Text("camera 'top'"), "camera 'top' is not valid: pos: is wrong");
}

TEST(Problems, ListsSeveralWithTheirPaths) {
  Problems problems;
  problems.Add("a");
  {
    Problems::Scope list(problems, "robots");
    Problems::Scope item(problems, 2);
    problems.Add("b");
    problems.AddAt("pos", "c");
  }
  problems.AddAt("name", "d");
  EXPECT_EQ(problems.Text("scene"),
            "scene is not valid, 4 problems:\n  a\n  robots[2]: b\n  robots[2].pos: c\n  name: d");
}

TEST(Problems, ReportsListEntriesByName) {
  Problems problems;
  {
    Problems::Scope robots(problems, "robots");
    problems.NameEntry(0, LabelOf("robot", "left"));
    problems.NameEntry(1, LabelOf("robot", ""));
    Problems::Scope first(problems, 0);
    Problems::Scope tools(problems, "attachments");
    problems.NameEntry(2, LabelOf("attachment", "g_"));
  }
  EXPECT_EQ(problems.Shown("robots[0]"), "robot 'left' (robots[0])");
  EXPECT_EQ(problems.Shown("robots[0].config.home"), "robot 'left' (robots[0]).config.home");
  EXPECT_EQ(problems.Shown("robots[1].path"), "robots[1].path");
  EXPECT_EQ(problems.Shown("robots[0].attachments[2].pos[1]"),
            "robot 'left' / attachment 'g_' (robots[0].attachments[2]).pos[1]");
  problems.AddAt("robots[0].path", "is empty");
  EXPECT_EQ(problems.Text("scene"), "scene is not valid: robot 'left' (robots[0]).path: is empty");
  Problems whole;
  {
    Problems::Scope scope(whole, "cell");
    whole.AppendBelow(problems);
  }
  EXPECT_EQ(whole.Text("rig"), "rig is not valid: robot 'left' (cell.robots[0]).path: is empty");
}

TEST(Problems, UsesTheNearestKnownPlace) {
  const auto sources = std::make_shared<SourceMap>(
      SourceMap{{"", "f:1:1"}, {"robots[0]", "f:3:5"}, {"robots[0].pos", "f:4:7"}});
  Problems problems{Locations(sources)};
  problems.AddAt("robots[0].pos[1]", "x");
  problems.AddAt("robots[0].base.size", "y");
  problems.AddAt("name", "z");
  EXPECT_EQ(problems.list()[0].source, "f:4:7");
  EXPECT_EQ(problems.list()[1].source, "f:3:5");
  EXPECT_EQ(problems.list()[2].source, "f:1:1");
}

TEST(Problems, KeepsThePlaceOfAMessage) {
  const auto sources = std::make_shared<SourceMap>(SourceMap{{"robot", "run.yaml:1:1"}});
  Problems problems{Locations(sources)};
  problems.AddAt("robot", "my robots/r.yaml:7:73: no joint 'j8': why: so");
  EXPECT_EQ(problems.Text("run.yaml"),
            "run.yaml is not valid: my robots/r.yaml:7:73: no joint 'j8': why: so");
  problems.AddAt("robot", "at 12:30: no place");
  problems.AddAt("robot", ":7:73: no file");
  EXPECT_EQ(problems.list()[1].source, "run.yaml:1:1");
  EXPECT_EQ(problems.list()[2].source, "run.yaml:1:1");
}

TEST(Problems, PrefixesProblemsOfAPartWithItsPath) {
  Problems part;
  part.AddAt("home.arm", "x");
  part.Add("y");
  Problems whole;
  {
    Problems::Scope scope(whole, "robot");
    whole.AppendBelow(part);
  }
  EXPECT_EQ(whole.list()[0].path, "robot.home.arm");
  EXPECT_EQ(whole.list()[1].path, "robot");
}

TEST(Problems, ThrowsOnlyIfAnyExist) {
  Problems problems;
  EXPECT_NO_THROW(problems.Throw("it"));
  problems.Add("x");
  ExpectThrow<SpecError>([&] { problems.Throw("it"); }, "it is not valid: x");
}

}  // namespace
}  // namespace robocell
